// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose2.h"

namespace floorloc {

/// A measured pose of the base in the frame of an anchor (a keyframe), with the covariance of (x, y, yaw), additive in
/// the anchor's frame.
struct AnchoredPose {
  Pose2 anchor_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Covariance of the motion from.Between(to), additive in the frame of the base at `from`, when both poses were
/// measured against one anchor. Half of their variance is the anchor's own noise, which they share. A `from` without
/// covariance is the anchor itself.
Eigen::Matrix3d MotionCovariance(const AnchoredPose& from, const AnchoredPose& to);

/// Covariance of the motion alike, such that motions that are taken as independent add up to `to`'s covariance:
/// what `to` is less certain than `from`, moved there; zero in directions in which it is not.
Eigen::Matrix3d IncrementalCovariance(const AnchoredPose& from, const AnchoredPose& to);

/// The covariance of `from` propagated by an independent motion with that covariance, as a filter would do.
Eigen::Matrix3d PropagatedCovariance(const AnchoredPose& from, const Pose2& motion,
                                     const Eigen::Matrix3d& motion_covariance);

}  // namespace floorloc
