// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/state_history.h"

#include <algorithm>
#include <cmath>

#include "core/fusion/fix_gate.h"
#include "core/fusion/sensor_reset.h"
#include "core/fusion/visual_correction.h"

namespace floorloc {
namespace {

// Interval of the remembered states, which bounds the recomputation after a late message.
constexpr std::int64_t kCheckpointNs = 200'000'000;

}  // namespace

bool StateHistory::IsTooOld(std::int64_t stamp_ns) const {
  return newest_ns_ && stamp_ns < *newest_ns_ - ToNanoseconds(options_.history_s);
}

void StateHistory::Start(std::int64_t stamp_ns) {
  if (states_.empty()) {
    states_.push_back({InitialState(stamp_ns, options_)});
    if (resumed_) {
      floorloc::Resume(*resumed_, &states_.back().state);
    }
  }
}

void StateHistory::Advance(std::int64_t stamp_ns) {
  newest_ns_ = std::max(newest_ns_.value_or(stamp_ns), stamp_ns);
  if (!states_.empty() && *newest_ns_ - states_.back().state.stamp_ns >= 2 * kCheckpointNs) {
    states_.push_back({StateAt(*newest_ns_ - kCheckpointNs)});
  }
  Trim();
}

void StateHistory::Trim() {
  const std::int64_t horizon_ns = *newest_ns_ - ToNanoseconds(options_.history_s);
  while (states_.size() > 1 && states_[1].state.stamp_ns <= horizon_ns) {
    states_.pop_front();
  }
  const std::int64_t needed_ns = states_.empty() ? horizon_ns : std::min(horizon_ns, states_.front().state.stamp_ns);
  const auto trim = [&](auto* track) {
    track->DropBefore(needed_ns);
    while (track->size() > options_.max_messages) {
      track->DropOldest();
    }
  };
  trim(&record_.wheels);
  trim(&record_.vision);
  trim(&record_.imu);
}

void StateHistory::Reset(const FilterState& state, const std::optional<PoseFix>& fix) {
  states_.clear();
  states_.push_back({state, std::nullopt, fix, fix.has_value()});
}

void StateHistory::ForgetMeasurements(std::int64_t newest_ns) {
  record_.Clear();
  newest_ns_ = newest_ns;
}

// The first state is never later than stamp_ns.
std::size_t StateHistory::LastBefore(std::int64_t stamp_ns) const {
  const auto after = std::upper_bound(states_.begin(), states_.end(), stamp_ns,
                                      [](std::int64_t stamp, const Checkpoint& c) { return stamp < c.state.stamp_ns; });
  return static_cast<std::size_t>(after - states_.begin()) - 1;
}

FilterState StateHistory::StateAt(std::int64_t stamp_ns) const {
  FilterState state = states_[LastBefore(stamp_ns)].state;
  Propagate(record_, options_, stamp_ns, &state);
  return state;
}

std::optional<Pose2> StateHistory::MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const {
  if (states_.empty() || from_ns < states_.front().state.stamp_ns || to_ns < from_ns) {
    return std::nullopt;
  }
  FilterState state = StateAt(from_ns);
  const Pose2 map_from_start = state.map_from_base;
  Propagate(record_, options_, to_ns, &state);
  return map_from_start.Between(state.map_from_base);
}

MotionEstimate StateHistory::MotionByNewest(std::int64_t from_ns, std::int64_t to_ns) const {
  FilterState moved = newest();
  moved.stamp_ns = from_ns;
  ResetPose(Pose2(), Eigen::Matrix3d::Zero(), &moved);
  Propagate(record_, options_, to_ns, &moved);
  return {moved.map_from_base, LargestSigma(moved.covariance.topLeftCorner<2, 2>()), std::sqrt(moved.covariance(2, 2))};
}

bool StateHistory::HasFixAt(std::int64_t stamp_ns) const {
  const std::optional<PoseFix>& last = states_[LastBefore(stamp_ns)].fix;
  return last && last->stamp_ns == stamp_ns;
}

// Index of the state at a time, which is added when there is none.
std::size_t StateHistory::CheckpointAt(std::int64_t stamp_ns) {
  const std::size_t before = LastBefore(stamp_ns);
  if (states_[before].state.stamp_ns == stamp_ns) {
    return before;
  }
  states_.insert(states_.begin() + static_cast<std::ptrdiff_t>(before + 1), {StateAt(stamp_ns)});
  return before + 1;
}

void StateHistory::AddVision(const MotionIncrement& increment) {
  if (increment.to_ns < states_.front().state.stamp_ns) {
    return;
  }
  const std::size_t index = CheckpointAt(increment.to_ns);
  states_[index].vision = increment;
  RepropagateFrom(index);
}

std::optional<FilterState> StateHistory::StateWithoutVision(std::int64_t since_ns, std::int64_t stamp_ns) const {
  MotionRecord record = record_;
  record.vision.DropAfter(since_ns);
  bool changed = false;
  std::size_t i = LastBefore(std::max(since_ns, states_.front().state.stamp_ns));
  FilterState state = states_[i].state;
  for (++i; i < states_.size() && states_[i].state.stamp_ns <= stamp_ns; ++i) {
    Checkpoint checkpoint = states_[i];
    changed = changed || checkpoint.vision;
    checkpoint.vision.reset();
    checkpoint.state = state;
    Propagate(record, options_, states_[i].state.stamp_ns, &checkpoint.state);
    Apply(&checkpoint);
    state = checkpoint.state;
  }
  Propagate(record, options_, stamp_ns, &state);
  return changed ? std::optional(state) : std::nullopt;
}

void StateHistory::DropVision(std::int64_t since_ns) {
  record_.vision.DropAfter(since_ns);
  const std::size_t first = LastBefore(std::max(since_ns, states_.front().state.stamp_ns)) + 1;
  for (std::size_t i = first; i < states_.size(); ++i) {
    states_[i].vision.reset();
  }
  RepropagateFrom(first);
}

void StateHistory::AddFix(const PoseFix& fix, bool accepted) {
  const std::size_t index = CheckpointAt(fix.stamp_ns);
  states_[index].fix = fix;
  states_[index].fix_accepted = accepted;
  if (index == 0 && accepted) {
    CorrectByFix(fix, &states_[0].state);
  }
  RepropagateFrom(index);
}

void StateHistory::RepropagateSince(std::int64_t stamp_ns) {
  if (!states_.empty() && states_.back().state.stamp_ns > stamp_ns) {
    RepropagateFrom(stamp_ns < states_.front().state.stamp_ns ? 0 : LastBefore(stamp_ns) + 1);
  }
}

// The first state has no predecessor to be predicted from and is kept.
void StateHistory::RepropagateFrom(std::size_t index) {
  for (std::size_t i = std::max<std::size_t>(index, 1); i < states_.size(); ++i) {
    const std::int64_t stamp = states_[i].state.stamp_ns;
    states_[i].state = states_[i - 1].state;
    Propagate(record_, options_, stamp, &states_[i].state);
    Apply(&states_[i]);
  }
}

// Applies the measurements of the checkpoint's time to the predicted state.
void StateHistory::Apply(Checkpoint* checkpoint) const {
  FilterState* state = &checkpoint->state;
  if (checkpoint->fix) {
    AdaptWheelNoise(*checkpoint->fix, options_.adaptation, state);
  }
  if (checkpoint->vision) {
    CorrectByVision(*checkpoint->vision, options_, state);
  }
  if (checkpoint->fix && checkpoint->fix_accepted) {
    CorrectByFix(*checkpoint->fix, state);
    state->path_m = state->turn_rad = 0.0;
  }
}

}  // namespace floorloc
