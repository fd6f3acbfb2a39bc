// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

/// Small deviation of a camera from its calibrated mounting, by vibration or a bent bracket.
struct MountingError {
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector of the camera, base frame
  double height_share = 0.0;                               ///< rise of the camera, as a share of its height
};

/// Derivative of the true position of a floor point with respect to (rotation, height share), 2x4, for a point that the
/// calibrated homography projects to `point_in_base`: to first order, true = calibrated + jacobian * error. The ray
/// from camera_center (base frame, metres) to the point rotates with the camera and intersects the floor at another
/// point.
Eigen::Matrix<double, 2, 4> MountingJacobian(const Eigen::Vector3d& camera_center,
                                             const Eigen::Vector2d& point_in_base);

}  // namespace floorloc
