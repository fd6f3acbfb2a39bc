// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/registration/registration.h"

namespace floorloc {

/// Errors that residuals do not show (calibration, vibration, the map): they shift and rotate the common floor as a
/// whole.
struct SystematicError {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// Covariance of (x, y, yaw) of target_from_source, additive in the target frame, when the floor around a point of the
/// target is shifted and rotated about that point, metres.
Eigen::Matrix3d SystematicCovariance(const Pose2& target_from_source, const Eigen::Vector2d& center_in_target,
                                     const SystematicError& error);

/// Mean target point of the inliers, metres. At least one inlier.
Eigen::Vector2d MeanTarget(const std::vector<OrientedMatch>& matches, const std::vector<int>& inliers);

}  // namespace floorloc
