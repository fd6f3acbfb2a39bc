// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/motion_track.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

bool IsValid(const MotionIncrement& increment) {
  return increment.to_ns > increment.from_ns && increment.motion.IsFinite() &&
         (!increment.covariance || increment.covariance->allFinite());
}

// Appends a fraction of an increment to a motion.
void Append(const MotionIncrement& increment, double share, TrackMotion* total) {
  const Pose2 motion = share < 1.0 ? Pose2::Exp(share * increment.motion.Log()) : increment.motion;
  const Eigen::Matrix3d adjoint = motion.Inverse().Adjoint();
  total->covariance = adjoint * total->covariance * adjoint.transpose();
  if (increment.covariance) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = motion.rotation().transpose();
    total->covariance += share * turn * *increment.covariance * turn.transpose();
  } else {
    total->has_covariance = false;
  }
  total->motion = total->motion * motion;
  total->path_m += motion.translation().norm();
  total->turn_rad += std::abs(motion.yaw());
}

}  // namespace

std::deque<MotionIncrement>::const_iterator MotionTrack::FirstEndingAfter(std::int64_t stamp_ns) const {
  return std::upper_bound(increments_.begin(), increments_.end(), stamp_ns,
                          [](std::int64_t stamp, const MotionIncrement& i) { return stamp < i.to_ns; });
}

MessageOutcome MotionTrack::Add(const MotionIncrement& increment) {
  if (!IsValid(increment)) {
    return MessageOutcome::kInvalid;
  }
  const auto next = increments_.begin() + (FirstEndingAfter(increment.to_ns) - increments_.cbegin());
  MotionIncrement placed = increment;
  if (next != increments_.begin()) {
    const MotionIncrement& previous = *std::prev(next);
    if (previous.to_ns == increment.to_ns) {
      return MessageOutcome::kDuplicate;
    }
    placed.from_ns = std::max(placed.from_ns, previous.to_ns);
  }
  const bool late = next != increments_.end();
  if (late) {
    next->from_ns = std::max(next->from_ns, placed.to_ns);
  }
  increments_.insert(next, placed);
  return late ? MessageOutcome::kUsedLate : MessageOutcome::kUsed;
}

void MotionTrack::DropBefore(std::int64_t stamp_ns) {
  while (!increments_.empty() && increments_.front().to_ns < stamp_ns) {
    increments_.pop_front();
  }
}

void MotionTrack::DropAfter(std::int64_t stamp_ns) {
  while (!increments_.empty() && increments_.back().to_ns > stamp_ns) {
    increments_.pop_back();
  }
}

void MotionTrack::DropOldest() { increments_.pop_front(); }

void MotionTrack::Shift(std::int64_t by_ns) {
  for (MotionIncrement& increment : increments_) {
    increment.from_ns += by_ns;
    increment.to_ns += by_ns;
  }
}

std::int64_t MotionTrack::CoveredUntil(std::int64_t from_ns, std::int64_t limit_ns) const {
  std::int64_t covered = from_ns;
  for (auto i = FirstEndingAfter(from_ns); i != increments_.end() && i->from_ns <= covered && covered < limit_ns; ++i) {
    covered = i->to_ns;
  }
  return std::min(covered, limit_ns);
}

std::int64_t MotionTrack::NextStart(std::int64_t from_ns, std::int64_t limit_ns) const {
  for (auto i = FirstEndingAfter(from_ns); i != increments_.end(); ++i) {
    if (i->from_ns >= from_ns) {
      return std::min(i->from_ns, limit_ns);
    }
  }
  return limit_ns;
}

TrackMotion MotionTrack::Between(std::int64_t from_ns, std::int64_t to_ns) const {
  TrackMotion total;
  total.has_covariance = true;
  for (auto i = FirstEndingAfter(from_ns); i != increments_.end() && i->from_ns < to_ns; ++i) {
    const auto used_ns = static_cast<double>(std::min(i->to_ns, to_ns) - std::max(i->from_ns, from_ns));
    Append(*i, used_ns / static_cast<double>(i->to_ns - i->from_ns), &total);
  }
  return total;
}

}  // namespace floorloc
