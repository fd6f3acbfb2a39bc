// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/prune_keypoints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/geometry/option_check.h"
#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

struct Cell {
  double covered_m2 = 0.0;
  std::vector<int> points;
};

// Covered area of the square cell that contains the point, by sampling.
double CoveredM2(const Eigen::Vector2d& point, double cell_m, const CoverageGrid& coverage) {
  constexpr int kSamples = 5;  // per side
  const Eigen::Vector2d corner = (point / cell_m).array().floor() * cell_m;
  int covered = 0;
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      const Eigen::Vector2d offset(column + 0.5, row + 0.5);
      covered += coverage.CountAt(corner + offset * cell_m / kSamples) > 0 ? 1 : 0;
    }
  }
  return cell_m * cell_m * std::max(covered, 1) / (kSamples * kSamples);
}

// Sorted by key, since the order of a hash table is not deterministic.
std::vector<Cell> SortIntoCells(const std::vector<Eigen::Vector2d>& points, double cell_m,
                                const CoverageGrid& coverage) {
  std::map<std::int64_t, Cell> by_key;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Cell& cell = by_key[CellKey(points[i], cell_m)];
    if (cell.points.empty()) {
      cell.covered_m2 = CoveredM2(points[i], cell_m, coverage);
    }
    cell.points.push_back(static_cast<int>(i));
  }
  std::vector<Cell> cells;
  for (auto& [key, cell] : by_key) {
    cells.push_back(std::move(cell));
  }
  return cells;
}

// Points per square metre of the whole cell.
double Density(const Cell& cell) { return static_cast<double>(cell.points.size()) / cell.covered_m2; }

// Density limit at which all cells together hold this many points.
double WaterLevel(const std::vector<Cell>& cells, double points) {
  std::vector<const Cell*> by_density;
  double area = 0.0;  // of the cells above the limit
  for (const Cell& cell : cells) {
    by_density.push_back(&cell);
    area += cell.covered_m2;
  }
  std::sort(by_density.begin(), by_density.end(),
            [](const Cell* a, const Cell* b) { return Density(*a) < Density(*b); });
  for (const Cell* cell : by_density) {
    if (Density(*cell) * area >= points) {
      break;
    }
    points -= static_cast<double>(cell->points.size());
    area -= cell->covered_m2;
  }
  return points / std::max(area, 1e-12);
}

}  // namespace

PruningOptions PruningOptions::ForCamera(const FloorPlane& floor, int keypoints_per_frame) const {
  constexpr double kReferenceViewM2 = 0.129;
  constexpr double kReferenceKeypoints = 700.0;
  const double view_m2 = floor.roi.width_m() * floor.roi.height_m();
  PruningOptions adapted = *this;
  adapted.max_per_m2 *= kReferenceViewM2 / view_m2 * (keypoints_per_frame / kReferenceKeypoints);
  adapted.cell_m *= std::sqrt(view_m2 / kReferenceViewM2);
  return adapted;
}

void PruningOptions::Check() const {
  RequireOption(max_per_m2 > 0.0, "max_per_m2 must be positive");
  RequireOption(cell_m > 0.0, "cell_m must be positive");
}

std::vector<int> ChooseEvenly(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& usefulness,
                              const CoverageGrid& coverage, const PruningOptions& options) {
  options.Check();
  std::vector<Cell> cells = SortIntoCells(points, options.cell_m, coverage);
  const double budget = options.max_per_m2 * coverage.AreaM2();
  const double level = static_cast<double>(points.size()) <= budget ? HUGE_VAL : WaterLevel(cells, budget);
  std::vector<int> chosen;
  double share = 0.0;  // fraction of a point carried over to the next cell
  for (Cell& cell : cells) {
    const auto size = static_cast<double>(cell.points.size());
    share += std::min(size, level * cell.covered_m2);
    const auto count = std::min(cell.points.size(), static_cast<std::size_t>(share + 1e-9));
    share -= static_cast<double>(count);
    std::stable_sort(cell.points.begin(), cell.points.end(), [&](int a, int b) {
      return usefulness[static_cast<std::size_t>(a)] > usefulness[static_cast<std::size_t>(b)];
    });
    chosen.insert(chosen.end(), cell.points.begin(), cell.points.begin() + static_cast<std::ptrdiff_t>(count));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace floorloc
