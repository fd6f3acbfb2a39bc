// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/keypoint_usefulness.h"

#include <algorithm>
#include <unordered_map>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

constexpr std::size_t kBins = 16;

// Weight of the prior rate of a point's response bin, in frames.
constexpr double kPriorFrames = 2.0;

// Prior of the bins' rates and its weight in frames; bins with few points stay near it.
constexpr double kUnknownRate = 0.5;
constexpr double kUnknownFrames = 4.0;

// Below this distinctiveness two points are nearer than most views of one point are to each other.
constexpr std::uint8_t kDuplicateDistinctiveness = 32;
constexpr double kManyDuplicates = 0.2;

// The first view is what makes a point exist and is not counted in its repeat rate.
double OtherViews(const PointHistory& point) { return point.found - 1; }
double OtherFrames(const PointHistory& point) { return std::max(point.visible, point.found) - 1; }

}  // namespace

RepeatRates::RepeatRates(const std::vector<PointHistory>& points) {
  std::vector<float> responses;
  for (const PointHistory& point : points) {
    responses.push_back(point.response);
  }
  std::sort(responses.begin(), responses.end());
  for (std::size_t bin = 1; bin < kBins && !responses.empty(); ++bin) {
    upper_responses_.push_back(responses[responses.size() * bin / kBins]);
  }
  std::vector<double> views(upper_responses_.size() + 1, kUnknownRate * kUnknownFrames);
  std::vector<double> frames(views.size(), kUnknownFrames);
  rates_.resize(views.size());
  for (const PointHistory& point : points) {
    const auto upper = std::upper_bound(upper_responses_.begin(), upper_responses_.end(), point.response);
    const auto bin = static_cast<std::size_t>(upper - upper_responses_.begin());
    views[bin] += OtherViews(point);
    frames[bin] += OtherFrames(point);
  }
  std::transform(views.begin(), views.end(), frames.begin(), rates_.begin(), [](double v, double f) { return v / f; });
}

double RepeatRates::OfResponse(float response) const {
  const auto upper = std::upper_bound(upper_responses_.begin(), upper_responses_.end(), response);
  return rates_[static_cast<std::size_t>(upper - upper_responses_.begin())];
}

double RepeatRates::Of(const PointHistory& point) const {
  return (OtherViews(point) + kPriorFrames * OfResponse(point.response)) / (OtherFrames(point) + kPriorFrames);
}

std::vector<double> Usefulness(const std::vector<PointHistory>& points, const RepeatRates& rates) {
  std::vector<double> usefulness;
  for (const PointHistory& point : points) {
    usefulness.push_back(rates.Of(point) * point.distinctiveness / 255.0);
  }
  return usefulness;
}

void IgnoreDuplicatesWhereCommon(const std::vector<Eigen::Vector2d>& positions, double cell_m,
                                 std::vector<PointHistory>* points) {
  struct Cell {
    int points = 0;
    int duplicates = 0;
  };
  std::unordered_map<std::int64_t, Cell> cells;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Cell& cell = cells[CellKey(positions[i], cell_m)];
    ++cell.points;
    cell.duplicates += (*points)[i].distinctiveness < kDuplicateDistinctiveness ? 1 : 0;
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Cell& cell = cells[CellKey(positions[i], cell_m)];
    if (cell.duplicates > kManyDuplicates * cell.points) {
      (*points)[i].distinctiveness = 255;
    }
  }
}

}  // namespace floorloc
