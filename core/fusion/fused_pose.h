// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/fusion/odometry_trust.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Quality of a fused pose.
enum class TrackingState {
  kLocalized,         ///< the last image agreed, and the pose is good to FilterLimits::localized_*
  kTrackingOdometry,  ///< propagated by odometry since the last fix
  /// Uncertain by more than FilterLimits::lost_*, or contradicted by several images, that agree or not.
  kLost,
};
/// "localized", "tracking_odometry", "lost"
const char* ToString(TrackingState state);

/// Time, path and turn since the last accepted fix.
struct SinceFix {
  double seconds = 0.0;
  double metres = 0.0;   ///< length of the path
  double radians = 0.0;  ///< sum of absolute turns
};

/// Pose of a vehicle at one time. Frames as in REP-105: map may jump when a fix corrects it, odom never does.
struct FusedPose {
  std::int64_t stamp_ns = 0;
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw), additive, map frame; m^2, m rad, rad^2
  Pose2 map_from_odom;
  Pose2 odom_from_base;  ///< sum of the increments; identity at the first message
  TrackingState state = TrackingState::kLost;
  bool contradicted = false;              ///< the last fix contradicts it
  std::optional<SinceFix> since_fix;      ///< empty before the first fix
  std::optional<OdometryTrust> odometry;  ///< empty without wheel odometry
  double wheel_noise_factor = 1.0;        ///< variance of the wheels' noise against what OdometryNoise says, as learnt
};

/// Why a fix was not used.
enum class FixRejection {
  kNone,
  kWrongFixRisk,  ///< its p_wrong is too high
  kJumpDistance,  ///< too far from the predicted pose
  kJumpAngle,     ///< turned too far from the predicted heading
  kMahalanobis,   ///< within the other gates, but not compatible with both covariances
  kTooOld,        ///< older than the history
  kDuplicate,     ///< there is a fix of this time already
  kInvalid,       ///< not finite, or its covariance is none
  kCount,         ///< how many there are; stays last
};
/// "", "wrong_fix_risk", "jump_distance", "jump_angle", "mahalanobis", "too_old", "duplicate", "invalid"
const char* ToString(FixRejection reason);

/// Outcome of a fix.
struct FixOutcome {
  bool accepted = false;
  FixRejection reason = FixRejection::kNone;
  bool reanchored = false;           ///< the vehicle was relocalized: the pose was replaced, not corrected
  bool first = false;                ///< there was no pose before it
  double distance_m = 0.0;           ///< from the predicted pose
  double angle_rad = 0.0;            ///< likewise, absolute
  double mahalanobis_squared = 0.0;  ///< innovation against both covariances; chi-square with 3 degrees of freedom
};

}  // namespace floorloc
