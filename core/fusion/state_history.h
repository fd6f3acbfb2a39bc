// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/fusion/dead_reckoning.h"
#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/learnt_odometry.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// The measurements of the last seconds and the states of the filter at some of their times. A measurement is applied
/// at its own time however late it comes: the states after it are propagated anew. Bounded memory.
class StateHistory {
 public:
  explicit StateHistory(const PoseFilterOptions& options) : options_(options) {}

  /// Motion measurements. After a change before the newest state, call RepropagateSince().
  MotionRecord& record() { return record_; }
  const MotionRecord& record() const { return record_; }

  bool empty() const { return states_.empty(); }
  /// Time of the newest message; empty before the first one.
  std::optional<std::int64_t> newest_ns() const { return newest_ns_; }
  /// True when a measurement of this time is older than what is remembered.
  bool IsTooOld(std::int64_t stamp_ns) const;

  /// Adds the initial state unless there is a state. Messages before the first pose are kept too: they move
  /// odom_from_base.
  void Start(std::int64_t stamp_ns);
  /// What the initial state knows of the wheels.
  void Resume(const LearntOdometry& learnt) { resumed_ = learnt; }
  const std::optional<LearntOdometry>& resumed() const { return resumed_; }
  /// A message of this time came: remembers states up to it and forgets the oldest ones.
  void Advance(std::int64_t stamp_ns);
  /// Replaces all states by one, which a fix may have set; the motion measurements stay.
  void Reset(const FilterState& state, const std::optional<PoseFix>& fix = std::nullopt);
  /// Forgets the motion measurements and goes on from another time.
  void ForgetMeasurements(std::int64_t newest_ns);

  /// The motion between two times as the states are propagated; empty when from_ns is before the oldest one, or after
  /// to_ns.
  std::optional<Pose2> MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const;

  // The following need a state; stamps are not before the oldest one.

  FilterState& oldest() { return states_.front().state; }
  const FilterState& oldest() const { return states_.front().state; }
  const FilterState& newest() const { return states_.back().state; }
  FilterState StateAt(std::int64_t stamp_ns) const;
  /// The motion between two times by the sensors, with the errors that were known of them at the newest state.
  MotionEstimate MotionByNewest(std::int64_t from_ns, std::int64_t to_ns) const;
  /// True when there was a fix at this very time, accepted or not.
  bool HasFixAt(std::int64_t stamp_ns) const;
  /// Corrects the state at the later image's time; older increments are ignored.
  void AddVision(const MotionIncrement& increment);
  /// The state at a time as if the motions between images that end after since_ns were not known; empty: there are
  /// none.
  std::optional<FilterState> StateWithoutVision(std::int64_t since_ns, std::int64_t stamp_ns) const;
  /// Forgets them.
  void DropVision(std::int64_t since_ns);
  /// accepted: false: the fix only adapts the noise.
  void AddFix(const PoseFix& fix, bool accepted);
  /// Fixes that were accepted stay accepted.
  void RepropagateSince(std::int64_t stamp_ns);
  void RepropagateAll() { RepropagateFrom(0); }

 private:
  // A remembered state and the measurements at its time.
  struct Checkpoint {
    FilterState state;  // after the measurements
    std::optional<MotionIncrement> vision = std::nullopt;
    std::optional<PoseFix> fix = std::nullopt;
    bool fix_accepted = false;
  };

  std::size_t LastBefore(std::int64_t stamp_ns) const;
  std::size_t CheckpointAt(std::int64_t stamp_ns);
  void RepropagateFrom(std::size_t index);
  void Apply(Checkpoint* checkpoint) const;
  void Trim();

  const PoseFilterOptions options_;
  MotionRecord record_;
  std::deque<Checkpoint> states_;  // by time
  std::optional<std::int64_t> newest_ns_;
  std::optional<LearntOdometry> resumed_;
};

}  // namespace floorloc
