// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/simple_fuser.h"

#include <algorithm>
#include <cmath>

#include "core/fusion/fix_gate.h"

namespace floorloc {

SimpleFuser::SimpleFuser(FusionMethod method, const FixGates& gates)
    : method_(method), jump_filter_(JumpFilterOptions{gates.max_distance_m, gates.max_angle_rad}) {}

MessageOutcome SimpleFuser::AddIncrement(MotionSource source, const MotionIncrement& increment) {
  if (!increment.motion.IsFinite()) {
    return MessageOutcome::kInvalid;
  }
  if (newest_ns_ && increment.to_ns < *newest_ns_ && increment.from_ns < *newest_ns_) {
    return MessageOutcome::kTooOld;
  }
  has_wheels_ = has_wheels_ || source == MotionSource::kWheels;
  newest_ns_ = std::max(newest_ns_.value_or(increment.to_ns), increment.to_ns);
  if (source == MotionSource::kVision && has_wheels_) {
    return MessageOutcome::kUsed;
  }
  odom_from_base_ = odom_from_base_ * increment.motion;
  if (method_ != FusionMethod::kFixes) {
    map_from_base_ = map_from_base_ * increment.motion;
  }
  since_fix_.metres += increment.motion.translation().norm();
  since_fix_.radians += std::abs(increment.motion.yaw());
  return MessageOutcome::kUsed;
}

MessageOutcome SimpleFuser::AddImu(const ImuReading& reading) {
  newest_ns_ = std::max(newest_ns_.value_or(reading.stamp_ns), reading.stamp_ns);
  return MessageOutcome::kUsed;
}

bool SimpleFuser::ShouldAccept(const PoseFix& fix) {
  switch (method_) {
    case FusionMethod::kIncrements:
      return !last_fix_;
    case FusionMethod::kJumpFilter:
      return jump_filter_.Accept(fix.map_from_base, odom_from_base_);
    default:
      return true;
  }
}

FixOutcome SimpleFuser::AddFix(const PoseFix& fix) {
  FixOutcome outcome;
  if (!IsValid(fix)) {
    outcome.reason = FixRejection::kInvalid;
    return outcome;
  }
  const Pose2 jump = map_from_base_.Between(fix.map_from_base);
  outcome.first = !last_fix_;
  outcome.accepted = ShouldAccept(fix);
  outcome.distance_m = outcome.first ? 0.0 : jump.translation().norm();
  outcome.angle_rad = outcome.first ? 0.0 : std::abs(jump.yaw());
  outcome.reason = outcome.accepted ? FixRejection::kNone : FixRejection::kJumpDistance;
  newest_ns_ = std::max(newest_ns_.value_or(fix.stamp_ns), fix.stamp_ns);
  if (outcome.accepted) {
    ResetPose(fix);
  }
  return outcome;
}

void SimpleFuser::ResetPose(const PoseFix& fix) {
  map_from_base_ = fix.map_from_base;
  last_fix_ = fix;
  since_fix_ = {};
}

void SimpleFuser::AddUnlocalizedFrame(std::int64_t) {}

void SimpleFuser::SetPose(const PoseFix& pose) {
  newest_ns_ = pose.stamp_ns;
  jump_filter_ = JumpFilter(jump_filter_.options());
  jump_filter_.Accept(pose.map_from_base, odom_from_base_);
  ResetPose(pose);
}

std::optional<FusedPose> SimpleFuser::Estimate() const {
  if (!last_fix_) {
    return std::nullopt;
  }
  FusedPose pose;
  pose.stamp_ns = *newest_ns_;
  pose.map_from_base = map_from_base_;
  pose.covariance = last_fix_->covariance;
  pose.odom_from_base = odom_from_base_;
  pose.map_from_odom = map_from_base_ * odom_from_base_.Inverse();
  pose.state = TrackingState::kLocalized;
  pose.since_fix = since_fix_;
  pose.since_fix->seconds = 1e-9 * static_cast<double>(*newest_ns_ - last_fix_->stamp_ns);
  return pose;
}

std::optional<FusedPose> SimpleFuser::EstimateAt(std::int64_t stamp_ns) const {
  return newest_ns_ && stamp_ns >= *newest_ns_ ? Estimate() : std::nullopt;
}

std::optional<Pose2> SimpleFuser::MotionBetween(std::int64_t, std::int64_t) const { return std::nullopt; }

}  // namespace floorloc
