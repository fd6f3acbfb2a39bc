// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/fusion/pose_fuser.h"

namespace floorloc {

/// How the twist at an image follows from the motion that was measured up to it.
struct FrameTwistOptions {
  /// Mean twists are taken over this time, or over an interval of the odometry where that is longer, seconds: two
  /// intervals of wheels that report at 50 Hz, and little longer than a read-out.
  double window_s = 0.04;
  double max_age_s = 0.5;  ///< motion that ends longer before an image does not tell its twist
  /// What the speed and the turn rate change by in the meantime, at most: brakes stop a robot with 5 m/s^2, and the
  /// odometry's noise is not to be extrapolated without end.
  double max_acceleration_mps2 = 5.0;
  double max_turn_acceleration_radps2 = 20.0;
  double max_extrapolation_s = 0.05;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The motion of a vehicle that was measured last, by its wheels or between two images.
struct LastMotion {
  std::optional<std::int64_t> until_ns;
  std::optional<MotionIncrement> wheels;  ///< the last message of the wheels
};

/// Twist (vx, vy, omega) of the base at an image, m/s and rad/s. The mean twist over the last window is that of half a
/// window ago; it is extrapolated by its change since the window before. Empty: nothing tells it.
std::optional<Eigen::Vector3d> TwistAtFrame(const PoseFuser& fuser, const LastMotion& last, std::int64_t stamp_ns,
                                            const FrameTwistOptions& options = {});

}  // namespace floorloc
