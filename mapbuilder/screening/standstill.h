// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

struct StandstillResult {
  std::vector<int> repeated;  ///< frames that show what the last frame before them that is not repeated shows
  int moved_by_odometry = 0;  ///< those of them at which odometry had moved on
};

/// Finds frames taken while the robot stood still, among `order` (indices into frames, in order of time, of one
/// camera): most keypoints are those of an earlier frame, and no corner of the floor moved by a third of a pixel since.
/// Slow motion is none: it adds up.
StandstillResult FindStationaryFrames(const std::vector<BuildFrame>& frames, const std::vector<int>& order,
                                      const RectM& floor, const PairRegistrationOptions& registration);

}  // namespace floorloc
