// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/odometry_monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace floorloc {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr std::size_t kMaxVotes = 12;

const WheelHypothesis kAsSaid{};

double Seconds(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

std::vector<WheelHypothesis> NamedFaults(const std::optional<double>& scale) {
  std::vector<WheelHypothesis> named = {{OdometryFault::kReversed, 1.0, 0.0},
                                        {OdometryFault::kAxesSwapped, 1.0, kQuarterTurn},
                                        {OdometryFault::kAxesSwapped, 1.0, -kQuarterTurn},
                                        {OdometryFault::kYawMirrored, 1.0, 0.0},
                                        {OdometryFault::kYawInDegrees, 1.0, 0.0}};
  if (scale) {
    named.push_back({OdometryFault::kScale, *scale, 0.0});
  }
  return named;
}

}  // namespace

bool IsPossibleMotion(const PoseFix& from, const PoseFix& to, const OdometryMonitorOptions& options) {
  const Pose2 motion = from.map_from_base.Between(to.map_from_base);
  const double seconds = Seconds(from.stamp_ns, to.stamp_ns);
  return motion.translation().norm() <= options.tolerance_m + options.max_speed_m_s * seconds &&
         std::abs(motion.yaw()) <= options.tolerance_rad + options.max_yaw_rate_rad_s * seconds;
}

void OdometryMonitor::AddWheels(const MotionIncrement& increment) {
  wheels_.Add(increment);
  wheels_.DropBefore(increment.to_ns - std::llround(1e9 * options_.window_s));
}

void OdometryMonitor::Clear() {
  wheels_.Clear();
  votes_.clear();
  clock_.Clear();
}

void OdometryMonitor::AddFix(const PoseFix& fix) {
  if (wheels_.empty() || (!votes_.empty() && fix.stamp_ns <= votes_.back().stamp_ns)) {
    return;
  }
  if (clock_.AddFix(fix, wheels_)) {
    votes_.clear();  // what they said of the wheels was a matter of the clock
    rejected_ = rejected_ && found_.fault != OdometryFault::kInconsistent;
  }
  Vote(fix);
}

OdometryMonitor::Interval OdometryMonitor::IntervalOf(std::size_t from, std::size_t to) const {
  const PoseFix& first = votes_[from];
  const PoseFix& second = votes_[to];
  return {first.map_from_base.Between(second.map_from_base), first.stamp_ns, second.stamp_ns};
}

std::optional<WheelPrediction> OdometryMonitor::Predict(const WheelHypothesis& hypothesis,
                                                        const Interval& interval) const {
  return wheels_.Between(hypothesis, interval.from_ns + offset_ns(), interval.to_ns + offset_ns(),
                         options_.max_offset_s);
}

// Keeps a fix when the vehicle moved since the last one that was kept, by the fixes or by the wheels.
void OdometryMonitor::Vote(const PoseFix& fix) {
  const std::int64_t oldest_ns = fix.stamp_ns - std::llround(1e9 * options_.window_s);
  std::erase_if(votes_, [oldest_ns](const PoseFix& vote) { return vote.stamp_ns < oldest_ns; });
  votes_.push_back(fix);
  if (votes_.size() < 2) {
    return;
  }
  const Interval last = IntervalOf(votes_.size() - 2, votes_.size() - 1);
  const std::optional<WheelPrediction> said = Predict(kAsSaid, last);
  if (!said) {
    votes_ = {fix};
    return;
  }
  const auto moved = [this](const Pose2& motion) {
    return motion.translation().norm() >= options_.min_motion_m || std::abs(motion.yaw()) >= options_.min_motion_rad;
  };
  if (!moved(last.by_fixes) && !moved(said->motion)) {
    votes_.pop_back();
    return;
  }
  if (votes_.size() > kMaxVotes) {
    votes_.pop_front();
  }
  rejected_ ? JudgeRejected() : Judge();
}

// What a hypothesis is off by on an interval, as a share of the tolerance; infinite where the wheels said nothing.
double OdometryMonitor::Misfit(const WheelHypothesis& hypothesis, const Interval& interval) const {
  const std::optional<WheelPrediction> said = Predict(hypothesis, interval);
  if (!said) {
    return std::numeric_limits<double>::infinity();
  }
  const Pose2 off = said->motion.Between(interval.by_fixes);
  const double path_m = std::max(interval.by_fixes.translation().norm(), said->motion.translation().norm());
  const double held_s2 = said->extrapolated_s * said->extrapolated_s;
  const double tolerance_m =
      options_.tolerance_m + options_.tolerance_scale * path_m + 0.5 * options_.max_acceleration_m_s2 * held_s2;
  const double tolerance_rad = options_.tolerance_rad + options_.tolerance_rad_per_m * path_m +
                               options_.tolerance_yaw_scale * std::abs(interval.by_fixes.yaw()) +
                               0.5 * options_.max_acceleration_rad_s2 * held_s2;
  return std::max(off.translation().norm() / tolerance_m, std::abs(off.yaw()) / tolerance_rad);
}

bool OdometryMonitor::Agrees(const WheelHypothesis& hypothesis, const Interval& interval) const {
  return Misfit(hypothesis, interval) <= 1.0;
}

bool OdometryMonitor::Contradicts(const WheelHypothesis& hypothesis, const Interval& interval) const {
  return Misfit(hypothesis, interval) >= options_.contradiction;
}

// Of the last votes; wheels that lie agree with no pair of fixes, a wrong fix leaves the others in agreement.
bool OdometryMonitor::EveryPairContradicts() const {
  const std::size_t first = votes_.size() - static_cast<std::size_t>(options_.fixes);
  for (std::size_t i = first; i < votes_.size(); ++i) {
    for (std::size_t j = i + 1; j < votes_.size(); ++j) {
      const bool possible = j > i + 1 || IsPossibleMotion(votes_[i], votes_[j], options_);
      if (!possible || !Contradicts(kAsSaid, IntervalOf(i, j))) {
        return false;
      }
    }
  }
  return true;
}

// How many of the last intervals that tell the hypothesis from right wheels are explained by it, up to the first that
// is not.
int OdometryMonitor::CountFor(const WheelHypothesis& hypothesis) const {
  int count = 0;
  for (std::size_t i = votes_.size(); i-- > 1;) {
    const Interval interval = IntervalOf(i - 1, i);
    if (!Agrees(hypothesis, interval)) {
      return count;
    }
    count += Contradicts(kAsSaid, interval) ? 1 : 0;
  }
  return count;
}

// Median ratio of the distances of the last intervals; empty when they differ, or were too short.
std::optional<double> OdometryMonitor::ScaleOfLast(std::size_t count) const {
  if (votes_.size() < count + 1) {
    return std::nullopt;
  }
  std::vector<double> ratios;
  for (std::size_t i = votes_.size() - count; i < votes_.size(); ++i) {
    const Interval interval = IntervalOf(i - 1, i);
    const std::optional<WheelPrediction> said = Predict(kAsSaid, interval);
    const double said_m = said ? said->motion.translation().norm() : 0.0;
    if (said_m < options_.tolerance_m) {
      return std::nullopt;
    }
    ratios.push_back(interval.by_fixes.translation().norm() / said_m);
  }
  std::sort(ratios.begin(), ratios.end());
  const double median = ratios[ratios.size() / 2];
  const bool steady = ratios.back() - ratios.front() <= 2.0 * options_.tolerance_scale * median;
  return steady ? std::optional(median) : std::nullopt;
}

std::optional<WheelHypothesis> OdometryMonitor::Explain() const {
  constexpr std::size_t kForScale = 3;
  for (const WheelHypothesis& fault : NamedFaults(ScaleOfLast(kForScale))) {
    const int needed = fault.fault == OdometryFault::kScale ? static_cast<int>(kForScale) : options_.named_intervals;
    if (CountFor(fault) >= needed) {
      return fault;
    }
  }
  if (static_cast<int>(votes_.size()) < options_.fixes || !EveryPairContradicts()) {
    return std::nullopt;
  }
  bool standing = true;
  for (std::size_t i = votes_.size() - static_cast<std::size_t>(options_.fixes) + 1; i < votes_.size(); ++i) {
    const std::optional<WheelPrediction> said = Predict(kAsSaid, IntervalOf(i - 1, i));
    standing = standing && said && said->motion.translation().norm() <= options_.tolerance_m &&
               std::abs(said->motion.yaw()) <= options_.tolerance_rad;
  }
  return WheelHypothesis{standing ? OdometryFault::kStanding : OdometryFault::kInconsistent, 1.0, 0.0};
}

void OdometryMonitor::Judge() {
  compared_ = compared_ || static_cast<int>(votes_.size()) >= options_.fixes;
  if (const std::optional<WheelHypothesis> fault = Explain()) {
    found_ = *fault;
    rejected_ = true;
    votes_to_trust_ = 0;
  }
}

// Wheels are trusted again when several intervals agree with them that the fault does not explain.
void OdometryMonitor::JudgeRejected() {
  const Interval last = IntervalOf(votes_.size() - 2, votes_.size() - 1);
  if (!Agrees(kAsSaid, last)) {
    votes_to_trust_ = Contradicts(kAsSaid, last) ? 0 : votes_to_trust_;
    if (const std::optional<WheelHypothesis> fault = Explain()) {
      found_ = *fault;
    }
    return;
  }
  const bool named = found_.fault != OdometryFault::kInconsistent && found_.fault != OdometryFault::kStanding;
  votes_to_trust_ += named && Agrees(found_, last) ? 0 : 1;
  if (votes_to_trust_ >= options_.intervals_to_trust) {
    rejected_ = false;
    found_ = {};
  }
}

OdometryTrust OdometryMonitor::Trust() const {
  OdometryTrust trust;
  trust.health = rejected_ ? OdometryHealth::kRejected : (compared_ ? OdometryHealth::kOk : OdometryHealth::kLearning);
  trust.fault = found_.fault;
  if (trust.fault == OdometryFault::kNone && offset_ns() != 0) {
    trust.fault = OdometryFault::kTimeOffset;  // compensated, so it does not touch the health
  }
  trust.scale = found_.fault == OdometryFault::kReversed ? -1.0 : found_.scale;
  trust.yaw_scale = found_.fault == OdometryFault::kYawMirrored    ? -1.0
                    : found_.fault == OdometryFault::kYawInDegrees ? std::numbers::pi / 180.0
                                                                   : 1.0;
  trust.time_offset_s = 1e-9 * static_cast<double>(offset_ns());
  return trust;
}

}  // namespace floorloc
