// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// How far a vehicle's wheel odometry is believed.
enum class OdometryHealth {
  kOk,        ///< agrees with the fixes
  kLearning,  ///< too few fixes yet to compare it with
  kSuspect,   ///< fixes contradicted it of late: its noise is raised to what they show
  kRejected,  ///< fixes contradict it again and again: it does not move the pose
  kCount,     ///< how many there are; stays last
};
/// "ok", "learning", "suspect", "rejected"
const char* ToString(OdometryHealth health);

/// What is wrong with it.
enum class OdometryFault {
  kNone,
  kReversed,      ///< forward is backward
  kAxesSwapped,   ///< translations are turned by a quarter turn
  kScale,         ///< distances are too long or too short
  kYawMirrored,   ///< left is right
  kYawInDegrees,  ///< turns are in degrees
  kStanding,      ///< no motion while the vehicle moves: encoder, cable, driver
  kTimeOffset,    ///< stamps are too early or too late
  kInconsistent,  ///< none of these: slip, a jump, or several at once
  kCount,         ///< how many there are; stays last
};
/// "", "reversed", "axes_swapped", "scale", "yaw_mirrored", "yaw_in_degrees", "standing", "time_offset", "inconsistent"
const char* ToString(OdometryFault fault);

/// What the fixes say of a vehicle's odometry.
struct OdometryTrust {
  OdometryHealth health = OdometryHealth::kLearning;
  OdometryFault fault = OdometryFault::kNone;
  double scale = 1.0;          ///< true distance / measured distance
  double yaw_scale = 1.0;      ///< true turn / measured turn
  double time_offset_s = 0.0;  ///< how much later the odometry is stamped than the images; compensated
};

/// One sentence that says what to do; empty without a fault.
const char* CureOf(OdometryFault fault);

}  // namespace floorloc
