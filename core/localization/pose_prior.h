// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry/pose2.h"

namespace floorloc {

/// Probable pose of the robot with search radii; only map keypoints visible from a pose within them are matched.
struct PosePrior {
  Pose2 map_from_base;
  double radius_m = 0.25;
  double yaw_radius_rad = 0.26;
};

}  // namespace floorloc
