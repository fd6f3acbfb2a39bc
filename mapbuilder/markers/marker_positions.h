// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace floorloc {

/// Where a marker is in the map, and where it should be.
struct MarkerPosition {
  Eigen::Vector2d found_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d expected_m = Eigen::Vector2d::Zero();
};

/// Distances between expected and found places after the rigid motion that suits most of them (least median of squares
/// over pairs of them), metres: a few wrong coordinates do not hide behind the others. At least two places.
std::vector<double> RobustResiduals(const std::vector<MarkerPosition>& positions);

/// Indices of the places that contradict the others. Empty for fewer than three places: two that disagree do not say
/// which of them is wrong.
std::vector<std::size_t> FindContradicting(const std::vector<MarkerPosition>& positions);

}  // namespace floorloc
