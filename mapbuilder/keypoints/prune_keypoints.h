// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapbuilder/coverage/coverage.h"

namespace floorloc {

/// For the sample camera (0.13 m2 in view, 700 keypoints).
struct PruningOptions {
  double max_per_m2 = 6000.0;  ///< budget: keypoints per surveyed square metre
  double cell_m = 0.1;         ///< side of the cells that share it; some should fit into a view

  PruningOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;
};

/// Chooses which points stay, evenly spread: every cell gets the same number per covered area, as water finds its
/// level; what cells with few points leave over goes to the others. In each cell the most useful ones stay. Returns
/// their indices, ascending; all when they fit the budget.
std::vector<int> ChooseEvenly(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& usefulness,
                              const CoverageGrid& coverage, const PruningOptions& options);

}  // namespace floorloc
