// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/registration/registration.h"

namespace floorloc {

/// The rigid motion that minimises the squared residuals of a subset of the matches (Umeyama 1991 without scale, in
/// closed form for the plane). subset: indices. Empty when it does not determine a rotation.
std::optional<Pose2> FitRigid(const std::vector<OrientedMatch>& matches, std::span<const int> subset);

/// Matches whose residual under the pose is at most radius_m.
std::vector<int> FindInliers(const std::vector<OrientedMatch>& matches, const Pose2& target_from_source,
                             double radius_m);

/// Root mean square residual of the subset, metres.
double RmsResidual(const std::vector<OrientedMatch>& matches, std::span<const int> subset,
                   const Pose2& target_from_source);

/// Covariance of (x, y, yaw) of target_from_source, additive in the target frame, for isotropic noise of sigma_m in
/// each coordinate of a residual: sigma^2 (J^T J)^-1.
Eigen::Matrix3d PoseCovariance(const std::vector<OrientedMatch>& matches, std::span<const int> subset,
                               const Pose2& target_from_source, double sigma_m);

}  // namespace floorloc
