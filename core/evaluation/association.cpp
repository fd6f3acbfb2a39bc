// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/association.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// Index of the pose nearest in time; the trajectory is not empty.
std::size_t NearestInTime(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto next = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                                     [](const StampedPose3& pose, std::int64_t ns) { return pose.stamp_ns < ns; });
  const auto after = static_cast<std::size_t>(next - trajectory.begin());
  if (after == 0) {
    return 0;
  }
  if (next == trajectory.end() || stamp_ns - std::prev(next)->stamp_ns <= next->stamp_ns - stamp_ns) {
    return after - 1;
  }
  return after;
}

}  // namespace

std::vector<PosePair> AssociateByTime(const Trajectory& reference, const Trajectory& estimate, double max_diff_s) {
  const bool estimate_is_longer = estimate.size() > reference.size();
  const Trajectory& longer = estimate_is_longer ? estimate : reference;
  const Trajectory& shorter = estimate_is_longer ? reference : estimate;
  std::vector<PosePair> pairs;
  for (const StampedPose3& pose : shorter) {
    const StampedPose3& nearest = longer[NearestInTime(longer, pose.stamp_ns)];
    if (std::abs(ToSeconds(nearest.stamp_ns - pose.stamp_ns)) <= max_diff_s) {
      pairs.push_back(estimate_is_longer ? PosePair{pose, nearest} : PosePair{nearest, pose});
    }
  }
  return pairs;
}

}  // namespace floorloc
