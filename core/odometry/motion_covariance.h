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
/// measured against one anchor. Half of their variance is the noise of the anchor, which they share. A `from` with zero
/// covariance is the anchor itself.
Eigen::Matrix3d MotionCovariance(const AnchoredPose& from, const AnchoredPose& to);

/// Covariance of the same motion for filters that treat motions as independent: the covariance of `to` minus that of
/// `from` propagated to it, clamped to positive semidefinite, so that successive motions add up to the covariance of
/// `to`.
Eigen::Matrix3d IncrementalCovariance(const AnchoredPose& from, const AnchoredPose& to);

/// Covariance of `from` propagated by an independent motion, as a filter does.
Eigen::Matrix3d PropagatedCovariance(const AnchoredPose& from, const Pose2& motion,
                                     const Eigen::Matrix3d& motion_covariance);

}  // namespace floorloc
