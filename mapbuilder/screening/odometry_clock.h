// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/io/trajectory.h"
#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// The sigmas are those of a vehicle's wheels (OdometryMonitorOptions::clock_sigma_m and following); where the motions
/// scatter more, their own scatter is taken.
struct OdometryClockOptions {
  double max_offset_s = 1.0;   ///< between the clocks; more is not searched for
  double min_offset_s = 0.02;  ///< less does no harm: 6 mm at 0.3 m/s
  int max_motions = 300;       ///< compared per survey: half of them where odometry changes most
  double sigma_m = 0.002;
  double sigma_rad = 0.003;
  double sigma_share = 0.015;  ///< of the distance or the turn
  /// Only motions tell that an offset changes by this squared residual, twice what noise alone makes of 3 degrees of
  /// freedom.
  double min_change = 6.0;
  int min_telling = 6;  ///< motions, before an offset is believed
  /// Share of the squared residuals that the offset may leave, of those without it and of those with the opposite one:
  /// interpolation smooths noise, whichever way odometry is moved. As OdometryMonitorOptions::clock_max_left.
  double max_left = 0.4;
  /// Or more, where many motions agree: the gain in standard errors. One of 3 million by chance.
  double min_gain_sigmas = 5.0;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What the images show of the motion between two of them.
struct TimedMotion {
  std::int64_t first_ns = 0;
  std::int64_t second_ns = 0;
  Pose2 first_from_second;
};

/// How much later than the odometry the images are stamped, from turns and changes of speed: the shift at which
/// odometry's motions are those of the images. Empty: none that is certain and matters.
std::optional<std::int64_t> FindImageDelayNs(const std::vector<TimedMotion>& motions, const Trajectory& odometry,
                                             const OdometryClockOptions& options);

/// Puts the odometry of every survey on the clock of its images. Names each offset, one sentence with its cure.
std::vector<std::string> MendOdometryClock(const PairRegistrationOptions& registration,
                                           const OdometryClockOptions& options, FrameSet* set);

}  // namespace floorloc
