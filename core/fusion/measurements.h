// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Rounded to the nearest nanosecond.
std::int64_t ToNanoseconds(double seconds);

/// Motion of the robot between two times, measured by wheels or images.
struct MotionIncrement {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;  ///< later than from_ns
  Pose2 motion;            ///< pose of the base at to_ns in the base frame at from_ns
  /// Of (x, y, yaw), additive, in the base frame at from_ns; m^2, m rad, rad^2. Empty: by OdometryNoise.
  std::optional<Eigen::Matrix3d> covariance;
};

/// Motion of the base between two times, by increments and IMU.
struct MotionEstimate {
  Pose2 motion;  ///< pose of the base at the second time in the base frame at the first
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// One reading of an IMU whose axes are those of the base frame: the mean since the reading before it. MEMS sensors
/// filter what they sample and are read when that is done: taken for the values at its stamp, a reading would be half
/// an interval late, which is ten milliradians where the yaw rate changes by 2 rad/s at 100 Hz.
struct ImuReading {
  std::int64_t stamp_ns = 0;
  double yaw_rate_rad_s = 0.0;
  Eigen::Vector2d acceleration_m_s2 = Eigen::Vector2d::Zero();  ///< forward and left
};

/// A pose measured in the map from one image.
struct PoseFix {
  std::int64_t stamp_ns = 0;  ///< when the image was taken, not when it was processed
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw), additive, map frame; m^2, m rad, rad^2
  double p_wrong = 0.0;                                  ///< probability that the pose is wrong
};

/// Outcome of a message.
enum class MessageOutcome {
  kUsed,
  kUsedLate,   ///< out of order; inserted at its time
  kDuplicate,  ///< there is a message of this time already; ignored
  kTooOld,     ///< older than the history; ignored
  kClockJump,  ///< the sender's clock was set; the history restarts with this message
  kInvalid,    ///< not finite, or ends before it begins; ignored
  kCount,      ///< how many there are; stays last
};
/// "used", "used_late", "duplicate", "too_old", "clock_jump", "invalid"
const char* ToString(MessageOutcome outcome);

}  // namespace floorloc
