// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/odometry_trust.h"

namespace floorloc {

const char* ToString(OdometryHealth health) {
  switch (health) {
    case OdometryHealth::kOk:
      return "ok";
    case OdometryHealth::kLearning:
      return "learning";
    case OdometryHealth::kSuspect:
      return "suspect";
    case OdometryHealth::kRejected:
      return "rejected";
    case OdometryHealth::kCount:
      break;
  }
  return "";
}

const char* ToString(OdometryFault fault) {
  switch (fault) {
    case OdometryFault::kReversed:
      return "reversed";
    case OdometryFault::kAxesSwapped:
      return "axes_swapped";
    case OdometryFault::kScale:
      return "scale";
    case OdometryFault::kYawMirrored:
      return "yaw_mirrored";
    case OdometryFault::kYawInDegrees:
      return "yaw_in_degrees";
    case OdometryFault::kStanding:
      return "standing";
    case OdometryFault::kTimeOffset:
      return "time_offset";
    case OdometryFault::kInconsistent:
      return "inconsistent";
    case OdometryFault::kNone:
    case OdometryFault::kCount:
      break;
  }
  return "";
}

const char* CureOf(OdometryFault fault) {
  switch (fault) {
    case OdometryFault::kReversed:
      return "The odometry goes backward while the images go forward: change the sign of dx and dy.";
    case OdometryFault::kAxesSwapped:
      return "The odometry's translation is turned by 90 degrees against the images: x is forward, y is left.";
    case OdometryFault::kScale:
      return "The odometry's distances are not those of the images: check the wheels' radius, the gear and the unit.";
    case OdometryFault::kYawMirrored:
      return "The odometry turns right while the images turn left: yaw counts counter-clockwise.";
    case OdometryFault::kYawInDegrees:
      return "The odometry's turns are some 57 times those of the images: dyaw is in radians, not degrees.";
    case OdometryFault::kStanding:
      return "The odometry stands still while the images move: check the encoders, their cables and the driver.";
    case OdometryFault::kTimeOffset:
      return "The odometry and the images are stamped by clocks that differ: synchronize them.";
    case OdometryFault::kInconsistent:
      return "The odometry contradicts the images: the wheels slip, or several things are wrong with it at once.";
    case OdometryFault::kNone:
    case OdometryFault::kCount:
      break;
  }
  return "";
}

}  // namespace floorloc
