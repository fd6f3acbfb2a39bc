// SPDX-License-Identifier: Apache-2.0
#include "core/registration/systematic_covariance.h"

namespace floorloc {

Eigen::Matrix3d SystematicCovariance(const Pose2& target_from_source, const Eigen::Vector2d& center_in_target,
                                     const SystematicError& error) {
  const Eigen::Vector2d arm = target_from_source.translation() - center_in_target;
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -arm.y();
  jacobian(1, 2) = arm.x();
  const Eigen::Vector3d sigma(error.sigma_m, error.sigma_m, error.sigma_rad);
  return jacobian * sigma.cwiseAbs2().asDiagonal() * jacobian.transpose();
}

Eigen::Vector2d MeanTarget(const std::vector<OrientedMatch>& matches, const std::vector<int>& inliers) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const int i : inliers) {
    sum += matches[static_cast<std::size_t>(i)].target_m;
  }
  return sum / static_cast<double>(inliers.size());
}

}  // namespace floorloc
