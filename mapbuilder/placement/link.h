// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose2.h"

namespace floorloc {

/// A measured motion between two frames: first_from_second with covariance.
struct Link {
  int first = 0;
  int second = 0;
  Pose2 first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive in the first's frame
  int inliers = 0;
  double rms_m = 0.0;
  /// Mean similarity of the keypoints of the shared floor, 0 ... 1; 0: not measured.
  double agreement = 0.0;
  /// That of the second best motion that is beyond chance; 0: there was none. Floors that repeat themselves have one.
  double rival_agreement = 0.0;
};

}  // namespace floorloc
