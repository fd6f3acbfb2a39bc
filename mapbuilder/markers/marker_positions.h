// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace floorloc {

/// Position of a marker in the map, and the surveyed one.
struct MarkerPosition {
  Eigen::Vector2d found_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d expected_m = Eigen::Vector2d::Zero();
};

/// Distances in metres between expected and found positions after the best rigid motion (least median of squares over
/// pairs of positions), so that a few wrong coordinates stand out. positions: at least two.
std::vector<double> RobustResiduals(const std::vector<MarkerPosition>& positions);

/// Indices of positions that contradict the others. Empty for fewer than three: of two that disagree, the wrong one is
/// unknown.
std::vector<std::size_t> FindContradicting(const std::vector<MarkerPosition>& positions);

/// The quarter turns, -1, 1 or 2, by which all of two or more yaws are off alike; 0 when they are not.
int CommonQuarterTurn(const std::vector<double>& yaw_errors_rad, double tolerance_rad);

}  // namespace floorloc
