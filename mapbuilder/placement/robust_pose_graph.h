// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {

struct RobustPoseGraphSummary {
  bool converged = false;
  int rejected_links = 0;  ///< removed from the graph as inconsistent with the rest
};

/// Optimises all poses and removes links that contradict the rest. A Cauchy loss suffices while hardly any link
/// disagrees; otherwise the outliers are found by graduated non-convexity with truncated least squares (Yang,
/// Antonante, Tzoumas & Carlone 2020, algorithm 1 with equations 13 and 14), which needs no good initial value: false
/// loop closures that agree with each other bias a merely robust optimum. Of the two results, the poses that more links
/// agree with are kept.
RobustPoseGraphSummary OptimizePosesRobustly(PoseGraph* graph);

}  // namespace floorloc
