// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/fusion/clock_offset.h"
#include "core/fusion/filter_options.h"
#include "core/fusion/measurements.h"
#include "core/fusion/odometry_trust.h"
#include "core/fusion/wheel_hypotheses.h"

namespace floorloc {

/// True when a vehicle can get from one fix to the other.
bool IsPossibleMotion(const PoseFix& from, const PoseFix& to, const OdometryMonitorOptions& options);

/// Judges wheel odometry by the fixes: their motion from one to the next needs no odometry. Wheels that contradict
/// several fixes, each of which a vehicle can reach from the one before, are rejected; what would explain them is
/// named. A wrong fix does not accuse the wheels: the fixes before and after it agree through them. Bounded memory.
class OdometryMonitor {
 public:
  explicit OdometryMonitor(const OdometryMonitorOptions& options) : options_(options), clock_(options) {}

  /// An increment as it was stamped.
  void AddWheels(const MotionIncrement& increment);
  /// A fix whose own risk is low, whether it agrees with the pose or not; fixes older than the last one are ignored.
  void AddFix(const PoseFix& fix);
  /// After a jump of the clock.
  void Clear();

  /// True: wheels may move the pose.
  bool Trusted() const { return !rejected_; }
  /// How much later the wheels are stamped than the images.
  std::int64_t offset_ns() const { return clock_.offset_ns(); }
  /// Starts with an offset that was found before.
  void ResumeOffset(std::int64_t offset_ns) { clock_.ResumeAt(offset_ns); }
  /// Scale and yaw scale are those of the fault that was found, else 1.
  OdometryTrust Trust() const;

 private:
  // Motion of the vehicle between two votes, and what the wheels said.
  struct Interval {
    Pose2 by_fixes;
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
  };

  void Vote(const PoseFix& fix);
  void Judge();
  void JudgeRejected();
  std::optional<WheelPrediction> Predict(const WheelHypothesis& hypothesis, const Interval& interval) const;
  double Misfit(const WheelHypothesis& hypothesis, const Interval& interval) const;
  bool Agrees(const WheelHypothesis& hypothesis, const Interval& interval) const;
  bool Contradicts(const WheelHypothesis& hypothesis, const Interval& interval) const;
  bool EveryPairContradicts() const;
  int CountFor(const WheelHypothesis& hypothesis) const;
  std::optional<WheelHypothesis> Explain() const;
  std::optional<double> ScaleOfLast(std::size_t count) const;
  Interval IntervalOf(std::size_t from, std::size_t to) const;

  const OdometryMonitorOptions options_;
  WheelHypotheses wheels_;
  ClockOffset clock_;
  std::deque<PoseFix> votes_;  // fixes with enough motion between them
  bool rejected_ = false;
  bool compared_ = false;   // there were votes enough to judge
  int votes_to_trust_ = 0;  // since the wheels were rejected
  WheelHypothesis found_;   // what is wrong with rejected wheels
};

}  // namespace floorloc
