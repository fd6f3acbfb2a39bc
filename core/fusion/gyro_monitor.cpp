// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/gyro_monitor.h"

#include <cmath>
#include <cstddef>

namespace floorloc {
namespace {

constexpr std::size_t kFixes = 3;  // a wrong one is told from a wrong gyro

double Seconds(const PoseFix& from, const PoseFix& to) {
  return 1e-9 * static_cast<double>(to.stamp_ns - from.stamp_ns);
}

}  // namespace

void GyroMonitor::AddFix(const PoseFix& fix, const ImuTrack& imu) {
  if (!fixes_.empty() && Seconds(fixes_.back(), fix) < options_.min_interval_s) {
    return;
  }
  if (!fixes_.empty() && Seconds(fixes_.back(), fix) > options_.max_interval_s) {
    fixes_.clear();
  }
  fixes_.push_back(fix);
  if (fixes_.size() > kFixes) {
    fixes_.pop_front();
  }
  if (fixes_.size() < kFixes) {
    return;
  }
  const Verdict verdict = Judge(imu);
  if (verdict == (rejected_ ? Verdict::kContradicts : Verdict::kAgrees)) {
    against_ = 0;
  } else if (verdict != Verdict::kSaysNothing) {
    ++against_;
  }
  if (against_ >= (rejected_ ? options_.agreements : options_.contradictions)) {
    rejected_ = !rejected_;
    against_ = 0;
  }
}

GyroMonitor::Verdict GyroMonitor::Judge(const ImuTrack& imu) const {
  const Verdict last = Compare(fixes_[1], fixes_[2], imu);
  if (last != Verdict::kContradicts) {
    return last;
  }
  const bool all = Compare(fixes_[0], fixes_[1], imu) == Verdict::kContradicts &&
                   Compare(fixes_[0], fixes_[2], imu) == Verdict::kContradicts;
  return all ? Verdict::kContradicts : Verdict::kSaysNothing;
}

GyroMonitor::Verdict GyroMonitor::Compare(const PoseFix& from, const PoseFix& to, const ImuTrack& imu) const {
  constexpr std::int64_t kMaxMissingNs = 100'000'000;  // the reading that covers the fix may still be on its way
  const std::int64_t until_ns = imu.empty() ? from.stamp_ns : imu.CoveredUntil(from.stamp_ns, to.stamp_ns);
  if (to.stamp_ns - until_ns > kMaxMissingNs) {
    return Verdict::kSaysNothing;
  }
  const double turned = from.map_from_base.Between(to.map_from_base).yaw();
  const double off = std::abs(imu.Between(from.stamp_ns, until_ns, ImuBias()).yaw_rad - turned);
  const double tolerance = options_.tolerance_rad + options_.tolerance_scale * std::abs(turned) +
                           options_.max_bias_rad_s * Seconds(from, to);
  if (off > tolerance) {
    return Verdict::kContradicts;
  }
  return std::abs(turned) >= options_.min_turn_rad ? Verdict::kAgrees : Verdict::kSaysNothing;
}

}  // namespace floorloc
