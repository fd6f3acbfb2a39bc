// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct StandstillResult {
  std::vector<int> repeated;  ///< frames that show the same as the last preceding frame that is not repeated
  int moved_by_odometry = 0;  ///< number of those at which odometry had moved
};

/// Finds frames taken during standstill among `order` (indices of one camera's frames, ordered by time): most keypoints
/// match those of an earlier frame, and no corner of the view has moved by a third of a pixel since. Slow motion is not
/// standstill, because it accumulates.
StandstillResult FindStationaryFrames(const std::vector<BuildFrame>& frames, const std::vector<int>& order,
                                      const RectM& floor, const PairRegistrationOptions& registration);

}  // namespace floorloc
