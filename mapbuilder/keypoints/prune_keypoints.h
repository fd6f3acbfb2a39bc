// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapbuilder/coverage/coverage.h"

namespace floorloc {

/// Defaults are for the sample camera (0.13 m2 in view, 700 keypoints).
struct PruningOptions {
  double max_per_m2 = 6000.0;  ///< budget: keypoints per covered square metre
  double cell_m = 0.1;         ///< side of the cells that share it; several should fit into a view

  PruningOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Chooses evenly spread points within the budget (water-filling): every cell gets the same number per covered area,
/// and what cells with few points do not use is given to the others. Each cell keeps its most useful points. Returns
/// their indices, ascending; all of them when they fit the budget.
std::vector<int> ChooseEvenly(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& usefulness,
                              const CoverageGrid& coverage, const PruningOptions& options);

}  // namespace floorloc
