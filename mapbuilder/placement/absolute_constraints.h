// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/known_points.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// A control point that the others contradict.
struct LeftOutControlPoint {
  int survey = 0;
  int point = 0;  ///< index in the survey's control points
  double misfit_m = 0.0;
};

struct ControlPointFindings {
  std::vector<LeftOutControlPoint> left_out;
  double scale = 1.0;  ///< distances between control points over those in the images, where it explains their misfit
};

/// Adds the frames' known poses and the surveys' control points to the graph as factors, and moves each connected part
/// rigidly onto its own, as an initial value. Control points that the others contradict are left out. Throws InputError
/// when there is only one, which does not fix the heading, and when control points or poses fit only with other axes or
/// units, or not at all.
ControlPointFindings AddAbsoluteConstraints(const std::vector<BuildFrame>& frames,
                                            const std::vector<LoadedSurvey>& surveys, const KnownPointOptions& options,
                                            PoseGraph* graph);

}  // namespace floorloc
