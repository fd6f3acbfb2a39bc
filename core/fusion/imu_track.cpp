// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/imu_track.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

constexpr std::int64_t kMaxGapNs = 100'000'000;  // longer pauses between readings are gaps

double Seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

Eigen::Matrix2d Rotation(double yaw) { return Pose2(0.0, 0.0, yaw).rotation(); }

// The reading holds for dt seconds.
void Extend(const ImuReading& reading, double dt, const ImuBias& bias, ImuMotion* motion) {
  const double turn = dt * (reading.yaw_rate_rad_s - bias.yaw_rate_rad_s);
  const Eigen::Matrix2d rotation = Rotation(motion->yaw_rad + 0.5 * turn);
  const Eigen::Vector2d acceleration = rotation * (reading.acceleration_m_s2 - bias.acceleration_m_s2);
  motion->position_m += dt * motion->velocity_m_s + 0.5 * dt * dt * acceleration;
  motion->position_by_bias += dt * motion->velocity_by_bias - 0.5 * dt * dt * rotation;
  motion->velocity_m_s += dt * acceleration;
  motion->velocity_by_bias -= dt * rotation;
  motion->yaw_rad += turn;
}

}  // namespace

std::deque<ImuReading>::const_iterator ImuTrack::FirstAfter(std::int64_t stamp_ns) const {
  return std::upper_bound(readings_.begin(), readings_.end(), stamp_ns,
                          [](std::int64_t stamp, const ImuReading& r) { return stamp < r.stamp_ns; });
}

MessageOutcome ImuTrack::Add(const ImuReading& reading) {
  if (!std::isfinite(reading.yaw_rate_rad_s) || !reading.acceleration_m_s2.allFinite()) {
    return MessageOutcome::kInvalid;
  }
  const auto next = FirstAfter(reading.stamp_ns);
  if (next != readings_.begin() && std::prev(next)->stamp_ns == reading.stamp_ns) {
    return MessageOutcome::kDuplicate;
  }
  const bool late = next != readings_.end();
  readings_.insert(next, reading);
  return late ? MessageOutcome::kUsedLate : MessageOutcome::kUsed;
}

void ImuTrack::DropBefore(std::int64_t stamp_ns) {
  while (readings_.size() > 1 && readings_[1].stamp_ns <= stamp_ns) {
    readings_.pop_front();
  }
}

void ImuTrack::DropOldest() { readings_.pop_front(); }

std::int64_t ImuTrack::CoveredUntil(std::int64_t from_ns, std::int64_t limit_ns) const {
  auto next = FirstAfter(from_ns);
  if (next == readings_.begin()) {
    return from_ns;
  }
  std::int64_t covered = std::prev(next)->stamp_ns;
  for (; next != readings_.end() && next->stamp_ns - covered <= kMaxGapNs && covered < limit_ns; ++next) {
    covered = next->stamp_ns;
  }
  return std::clamp(covered, from_ns, limit_ns);
}

std::int64_t ImuTrack::NextStart(std::int64_t from_ns, std::int64_t limit_ns) const {
  const auto next = FirstAfter(from_ns - 1);
  return next == readings_.end() ? limit_ns : std::min(next->stamp_ns, limit_ns);
}

ImuMotion ImuTrack::Between(std::int64_t from_ns, std::int64_t to_ns, const ImuBias& bias) const {
  ImuMotion motion;
  std::int64_t at_ns = from_ns;
  for (auto reading = FirstAfter(from_ns); at_ns < to_ns; ++reading) {
    const std::int64_t until_ns = std::min(reading->stamp_ns, to_ns);
    Extend(*reading, Seconds(until_ns - at_ns), bias, &motion);
    at_ns = until_ns;
  }
  return motion;
}

}  // namespace floorloc
