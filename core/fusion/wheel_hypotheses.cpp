// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/wheel_hypotheses.h"

#include <algorithm>
#include <numbers>

namespace floorloc {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kLastTwistNs = 100'000'000;  // over which the twist that is held is measured
constexpr std::size_t kMaxIncrements = 4096;

MotionIncrement WithTurn(const MotionIncrement& increment, double factor) {
  Eigen::Vector3d twist = increment.motion.Log();
  twist.z() *= factor;
  return {increment.from_ns, increment.to_ns, Pose2::Exp(twist), std::nullopt};
}

}  // namespace

void WheelHypotheses::Add(const MotionIncrement& increment) {
  as_said_.Add(increment);
  mirrored_.Add(WithTurn(increment, -1.0));
  degrees_.Add(WithTurn(increment, kRadPerDegree));
  for (MotionTrack* track : {&as_said_, &mirrored_, &degrees_}) {
    while (track->size() > kMaxIncrements) {
      track->DropOldest();
    }
  }
}

void WheelHypotheses::DropBefore(std::int64_t stamp_ns) {
  for (MotionTrack* track : {&as_said_, &mirrored_, &degrees_}) {
    track->DropBefore(stamp_ns);
  }
}

void WheelHypotheses::Clear() {
  for (MotionTrack* track : {&as_said_, &mirrored_, &degrees_}) {
    track->Clear();
  }
}

const MotionTrack& WheelHypotheses::TrackOf(OdometryFault fault) const {
  if (fault == OdometryFault::kYawMirrored) {
    return mirrored_;
  }
  return fault == OdometryFault::kYawInDegrees ? degrees_ : as_said_;
}

std::optional<WheelPrediction> WheelHypotheses::Between(const WheelHypothesis& hypothesis, std::int64_t from_ns,
                                                        std::int64_t to_ns, double max_gap_s) const {
  const MotionTrack& track = TrackOf(hypothesis.fault);
  const std::int64_t until_ns = track.CoveredUntil(from_ns, to_ns);
  const double gap_s = 1e-9 * static_cast<double>(to_ns - until_ns);
  if (until_ns <= from_ns || gap_s > max_gap_s) {
    return std::nullopt;
  }
  WheelPrediction said{track.Between(from_ns, until_ns).motion, gap_s};
  if (gap_s > 0.0) {
    const std::int64_t last_ns = std::min(kLastTwistNs, until_ns - from_ns);
    const Eigen::Vector3d twist = track.Between(until_ns - last_ns, until_ns).motion.Log();
    said.motion = said.motion * Pose2::Exp(gap_s / (1e-9 * static_cast<double>(last_ns)) * twist);
  }
  double factor = hypothesis.fault == OdometryFault::kReversed ? -1.0 : 1.0;
  factor *= hypothesis.fault == OdometryFault::kScale ? hypothesis.scale : 1.0;
  const double direction = hypothesis.fault == OdometryFault::kAxesSwapped ? hypothesis.direction_rad : 0.0;
  const Eigen::Vector2d translation = factor * (Pose2(0.0, 0.0, direction).rotation() * said.motion.translation());
  said.motion = Pose2(translation.x(), translation.y(), said.motion.yaw());
  return said;
}

}  // namespace floorloc
