// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Probable pose of the robot with search radii; only map keypoints visible from a pose within them are matched.
struct PosePrior {
  Pose2 map_from_base;
  double radius_m = 0.25;
  double yaw_radius_rad = 0.26;
  /// Probability that the robot is elsewhere where the floor looks alike, by whoever gives the prior and knows it from
  /// earlier frames (LatticeTracker). Empty: not known (SearchOptions::prior_failure_rate).
  std::optional<double> p_elsewhere = {};
};

}  // namespace floorloc
