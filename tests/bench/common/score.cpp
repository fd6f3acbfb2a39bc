// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/score.h"

#include <stdexcept>

#include "core/evaluation/alignment.h"

namespace floorloc {

Pose2 AlignMapToTruth(const std::vector<MapFrame>& frames, const Trajectory& ground_truth) {
  std::vector<PosePair> pairs;
  for (const MapFrame& frame : frames) {
    if (const std::optional<Pose2> truth = InterpolatePose(ground_truth, frame.stamp_ns)) {
      pairs.push_back({StampedPose3::FromPose2(frame.stamp_ns, *truth),
                       StampedPose3::FromPose2(frame.stamp_ns, frame.map_from_base)});
    }
  }
  if (pairs.size() < 2) {
    throw std::invalid_argument("fewer than two frames of the map have a pose in the survey's groundtruth.tum");
  }
  const Similarity3 truth_from_map = ComputeAlignment(pairs, AlignmentMode::kSe2);
  return (truth_from_map * StampedPose3()).ToPose2();
}

}  // namespace floorloc
