// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/fused_pose.h"

namespace floorloc {

const char* ToString(TrackingState state) {
  switch (state) {
    case TrackingState::kLocalized:
      return "localized";
    case TrackingState::kTrackingOdometry:
      return "tracking_odometry";
    case TrackingState::kLost:
      return "lost";
  }
  return "";
}

const char* ToString(FixRejection reason) {
  switch (reason) {
    case FixRejection::kNone:
      return "";
    case FixRejection::kWrongFixRisk:
      return "wrong_fix_risk";
    case FixRejection::kJumpDistance:
      return "jump_distance";
    case FixRejection::kJumpAngle:
      return "jump_angle";
    case FixRejection::kMahalanobis:
      return "mahalanobis";
    case FixRejection::kTooOld:
      return "too_old";
    case FixRejection::kDuplicate:
      return "duplicate";
    case FixRejection::kInvalid:
      return "invalid";
    case FixRejection::kCount:
      break;
  }
  return "";
}

}  // namespace floorloc
