// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/io/trajectory.h"

namespace floorloc {

/// A reference pose and its estimate at (nearly) the same time.
struct PosePair {
  StampedPose3 reference;
  StampedPose3 estimate;
};

/// Pairs every pose of the shorter trajectory with the pose of the longer one that is nearest in time (the earlier of
/// two equally near), if they are at most max_diff_s apart, as the trajectory tool evo does. Of equal lengths the
/// reference counts as the longer one. Sorted by time.
std::vector<PosePair> AssociateByTime(const Trajectory& reference, const Trajectory& estimate, double max_diff_s);

}  // namespace floorloc
