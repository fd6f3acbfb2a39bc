// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/fusion/motion_track.h"
#include "core/fusion/odometry_trust.h"

namespace floorloc {

/// What the wheels' true motion may have been, given what they said.
struct WheelHypothesis {
  OdometryFault fault = OdometryFault::kNone;
  double scale = 1.0;          ///< kScale: true distance / measured distance
  double direction_rad = 0.0;  ///< kAxesSwapped: turns the measured translation
};

/// A motion predicted by wheels.
struct WheelPrediction {
  Pose2 motion;                 ///< pose of the base at the second time in the base frame at the first
  double extrapolated_s = 0.0;  ///< at the end, for which there are no increments yet
};

/// The wheels' increments of the last seconds, integrated under each hypothesis.
class WheelHypotheses {
 public:
  void Add(const MotionIncrement& increment);
  void DropBefore(std::int64_t stamp_ns);
  void Clear();
  bool empty() const { return as_said_.empty(); }
  std::int64_t newest_ns() const { return as_said_.newest_ns(); }

  /// Motion between two times; the last twist is held for up to max_gap_s after the newest increment. Empty where
  /// increments are missing.
  std::optional<WheelPrediction> Between(const WheelHypothesis& hypothesis, std::int64_t from_ns, std::int64_t to_ns,
                                         double max_gap_s) const;

 private:
  const MotionTrack& TrackOf(OdometryFault fault) const;

  MotionTrack as_said_, mirrored_, degrees_;  // turns are nonlinear, so each has its own track
};

}  // namespace floorloc
