// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/pose_confirmation.h"

#include <cmath>
#include <numbers>

namespace floorloc {

std::optional<ActionVerdict> PoseConfirmation::Start(const std::string& action_id, const Expected& expected) {
  auto replaced = End(false, "Another initial pose took its place.");
  waiting_ = {action_id, expected};
  return replaced;
}

// By the gates of the vehicle's pose that compare places.
bool PoseConfirmation::Contradicts(const FixReport& fix) const {
  if (fix.reanchored && fix.pose) {
    const InitPosition& set = waiting_->expected.pose;
    const double turn = std::remainder(fix.pose->yaw - set.theta, 2.0 * std::numbers::pi);
    return std::hypot(fix.pose->x - set.x, fix.pose->y - set.y) > options_.max_distance_m ||
           std::abs(turn) > options_.max_angle_rad;
  }
  return fix.reject_reason == "jump_distance" || fix.reject_reason == "jump_angle" ||
         fix.reject_reason == "mahalanobis";
}

std::optional<ActionVerdict> PoseConfirmation::OnFix(const FixReport& fix) {
  if (!waiting_ || fix.sequence <= waiting_->expected.after_sequence || fix.status != "localized") {
    return std::nullopt;
  }
  if (Contradicts(fix)) {
    return End(false, "The next image was found elsewhere in the map.");
  }
  return fix.accepted.value_or(false) ? End(true, "The next image confirmed the pose.") : std::nullopt;
}

std::optional<ActionVerdict> PoseConfirmation::OnTime(double now_s) {
  return waiting_ && now_s > waiting_->expected.deadline_s
             ? End(false, "No image confirmed or contradicted the pose in time.")
             : std::nullopt;
}

std::optional<ActionVerdict> PoseConfirmation::End(bool succeeded, const std::string& sentence) {
  if (!waiting_) {
    return std::nullopt;
  }
  ActionVerdict verdict{waiting_->action_id, succeeded, sentence};
  waiting_.reset();
  return verdict;
}

}  // namespace floorloc
