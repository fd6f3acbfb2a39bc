// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/finished_map/base_map.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct LocateOptions {
  RunOptions run;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Localizes frames of new surveys in a map: first each frame globally, then those that failed near the pose predicted
/// by odometry from a localized frame. Returns the accepted fixes in the order of the frames. Throws InputError.
std::vector<PosePriorFactor> LocateInMap(const BaseMap& base_map, const std::vector<LoadedSurvey>& surveys,
                                         const std::vector<BuildFrame>& frames, const LocateOptions& options);

}  // namespace floorloc
