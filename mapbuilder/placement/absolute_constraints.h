// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Adds the frames' known poses and the surveys' control points to the graph as factors, and moves each connected part
/// rigidly onto its own, as an initial value. Throws InputError when there is only one: it does not fix the heading.
void AddAbsoluteConstraints(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                            PoseGraph* graph);

}  // namespace floorloc
