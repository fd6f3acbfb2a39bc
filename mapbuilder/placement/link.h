// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Measured relative pose of two frames: first_from_second with covariance.
struct Link {
  int first = 0;
  int second = 0;
  Pose2 first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive in the first's frame
  int inliers = 0;
  double rms_m = 0.0;
  /// Mean similarity of the keypoints on the shared floor, 0 ... 1; 0: not measured.
  double agreement = 0.0;
  /// Agreement of the second-best significant pose, 0: none. Self-similar floors have one.
  double rival_agreement = 0.0;
  double scale = 1.0;  ///< the second's height over the first's, by the inliers alone
};

}  // namespace floorloc
