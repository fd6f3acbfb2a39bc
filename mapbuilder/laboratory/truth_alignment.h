// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/experiment.h"

namespace floorloc {

/// Transforms the frames' true poses into the frame of a map that was built without them: localizes the frames (SIFT,
/// ratio test, RANSAC); each proposes a transform between the two frames, and the proposal that most others agree with
/// is refined over these. Throws InputError when no two frames agree.
void AlignTruthToMap(const FloorImage& map, const ExperimentOptions& options, std::vector<FrameBag>* bags);

}  // namespace floorloc
