// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

/// A small deviation of a camera from its calibrated mounting, as vibration or a bent bracket makes it.
struct MountingError {
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector of the camera, base frame
  double height_share = 0.0;                               ///< rise of the camera, as a share of its height
};

/// Derivative of where a floor point really is with respect to (rotation, height share), 2x4, for a point that the
/// calibrated homography puts at `point_in_base`: to first order, true = calibrated + jacobian * error. The ray from
/// camera_center (base frame, metres) to the point turns with the camera and meets the floor elsewhere.
Eigen::Matrix<double, 2, 4> MountingJacobian(const Eigen::Vector3d& camera_center,
                                             const Eigen::Vector2d& point_in_base);

}  // namespace floorloc
