// SPDX-License-Identifier: Apache-2.0
#include "core/registration/voting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace floorloc {
namespace {

struct Cell {
  int x = 0;
  int y = 0;
  int yaw = 0;
  auto operator<=>(const Cell&) const = default;
};

struct CellHash {
  std::size_t operator()(const Cell& c) const {
    auto h = static_cast<std::size_t>(c.x) * 0x9E3779B97F4A7C15ULL;
    h ^= static_cast<std::size_t>(c.y) * 0xC2B2AE3D27D4EB4FULL + (h >> 29);
    h ^= static_cast<std::size_t>(c.yaw) * 0x165667B19E3779F9ULL + (h >> 31);
    return h;
  }
};

using Votes = std::unordered_map<Cell, std::vector<int>, CellHash>;

class Grid {
 public:
  explicit Grid(const RegistrationOptions& options)
      : cell_m_(options.vote_cell_m),
        yaw_cells_(std::max(3, static_cast<int>(std::lround(2.0 * std::numbers::pi / options.vote_cell_rad)))) {}

  // False for poses out of range, as damaged keypoints produce them.
  bool Contains(const Eigen::Vector2d& p, double yaw) const {
    constexpr double kCells = 1e9;  // fits an int
    return std::abs(p.x()) < kCells * cell_m_ && std::abs(p.y()) < kCells * cell_m_ && std::isfinite(yaw);
  }
  Cell At(const Eigen::Vector2d& p, double yaw) const {
    const double turn = (yaw + std::numbers::pi) / (2.0 * std::numbers::pi);
    const int yaw_cell = static_cast<int>(std::floor(turn * yaw_cells_));
    return {static_cast<int>(std::floor(p.x() / cell_m_)), static_cast<int>(std::floor(p.y() / cell_m_)),
            Wrap(yaw_cell)};
  }
  Cell Neighbour(const Cell& c, int dx, int dy, int dyaw) const { return {c.x + dx, c.y + dy, Wrap(c.yaw + dyaw)}; }
  bool Adjacent(const Cell& a, const Cell& b) const {
    const int turn = Wrap(a.yaw - b.yaw);
    return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && (turn <= 1 || turn == yaw_cells_ - 1);
  }

 private:
  int Wrap(int yaw) const { return ((yaw % yaw_cells_) + yaw_cells_) % yaw_cells_; }

  double cell_m_;
  int yaw_cells_;
};

template <typename Visit>
void VisitNeighbourhood(const Grid& grid, const Votes& votes, const Cell& center, const Visit& visit) {
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dyaw = -1; dyaw <= 1; ++dyaw) {
        const auto it = votes.find(grid.Neighbour(center, dx, dy, dyaw));
        if (it != votes.end()) {
          visit(it->second);
        }
      }
    }
  }
}

}  // namespace

std::vector<VotePeak> FindVotePeaks(const std::vector<OrientedMatch>& matches, const Eigen::Vector2d& source_center,
                                    const RegistrationOptions& options) {
  const Grid grid(options);
  Votes votes;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const OrientedMatch& m = matches[i];
    const double yaw = m.Yaw();
    const Eigen::Vector2d center = m.target_m + Pose2(0.0, 0.0, yaw) * Eigen::Vector2d(source_center - m.source_m);
    if (grid.Contains(center, yaw)) {
      votes[grid.At(center, yaw)].push_back(static_cast<int>(i));
    }
  }
  // A cell's score includes its neighbours, so that a peak across a cell border is found.
  std::vector<std::pair<int, Cell>> scores;
  for (const auto& entry : votes) {
    int score = 0;
    VisitNeighbourhood(grid, votes, entry.first, [&](const auto& list) { score += static_cast<int>(list.size()); });
    scores.emplace_back(score, entry.first);
  }
  std::sort(scores.begin(), scores.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  std::vector<VotePeak> peaks;
  std::vector<Cell> centers;
  for (const auto& scored : scores) {
    const Cell& cell = scored.second;
    if (static_cast<int>(peaks.size()) == options.candidates) {
      break;
    }
    if (std::any_of(centers.begin(), centers.end(), [&](const Cell& c) { return grid.Adjacent(c, cell); })) {
      continue;
    }
    VotePeak peak{scored.first, {}};
    VisitNeighbourhood(grid, votes, cell,
                       [&](const auto& list) { peak.matches.insert(peak.matches.end(), list.begin(), list.end()); });
    std::sort(peak.matches.begin(), peak.matches.end());
    peaks.push_back(std::move(peak));
    centers.push_back(cell);
  }
  return peaks;
}

}  // namespace floorloc
