// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "core/fusion/measurements.h"

namespace floorloc {

/// Motion of a track between two times.
struct TrackMotion {
  Pose2 motion;  ///< pose of the base at the second time in the base frame at the first
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of xi in motion * Exp(xi)
  bool has_covariance = false;                           ///< false: the increments have none
  double path_m = 0.0;
  double turn_rad = 0.0;
};

/// The increments of one source by time; there may be gaps. An increment that arrives late is inserted at its time, and
/// the next one then begins where it ends, because senders mean "since the previous message" in the order of sending.
class MotionTrack {
 public:
  MessageOutcome Add(const MotionIncrement& increment);
  /// Drops increments that end before stamp_ns.
  void DropBefore(std::int64_t stamp_ns);
  /// Drops increments that end after stamp_ns.
  void DropAfter(std::int64_t stamp_ns);
  void DropOldest();
  void Clear() { increments_.clear(); }
  /// Moves all increments in time.
  void Shift(std::int64_t by_ns);

  bool empty() const { return increments_.empty(); }
  std::size_t size() const { return increments_.size(); }
  /// End of the newest increment. The track must not be empty.
  std::int64_t newest_ns() const { return increments_.back().to_ns; }

  /// How far, at most to limit_ns, the increments cover the motion from from_ns on without a gap; from_ns when they do
  /// not.
  std::int64_t CoveredUntil(std::int64_t from_ns, std::int64_t limit_ns) const;
  /// The first time from from_ns on at which an increment begins; limit_ns when there is none before it.
  std::int64_t NextStart(std::int64_t from_ns, std::int64_t limit_ns) const;
  /// Motion over a covered interval. Increments are split at constant twist.
  TrackMotion Between(std::int64_t from_ns, std::int64_t to_ns) const;

 private:
  std::deque<MotionIncrement>::const_iterator FirstEndingAfter(std::int64_t stamp_ns) const;

  std::deque<MotionIncrement> increments_;  // ascending, without overlap
};

}  // namespace floorloc
