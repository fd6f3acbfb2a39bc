// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {

struct RobustPoseGraphSummary {
  bool converged = false;
  int rejected_links = 0;  ///< removed from the graph: the rest contradicts them
};

/// Optimises all poses and finds the links that contradict the rest. A Cauchy loss suffices while hardly a link
/// disagrees; when more do, which ones are false is decided by graduated non-convexity with truncated least squares
/// (Yang, Antonante, Tzoumas & Carlone 2020, algorithm 1 with equations 13 and 14), which needs no good start: wrong
/// loop closures that agree with each other bend a merely robust optimum. The poses that more links agree with are
/// kept.
RobustPoseGraphSummary OptimizePosesRobustly(PoseGraph* graph);

}  // namespace floorloc
