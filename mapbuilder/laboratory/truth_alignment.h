// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/experiment.h"

namespace floorloc {

/// Brings the frames' truth into the frame of a map that was built without one: the frames are localized (SIFT, ratio
/// test, RANSAC), each proposes how the two frames lie to each other, and the proposal that most others agree with is
/// refined over those. Throws InputError when no two frames agree.
void AlignTruthToMap(const FloorImage& map, const ExperimentOptions& options, std::vector<FrameBag>* bags);

}  // namespace floorloc
