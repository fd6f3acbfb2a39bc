// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/evaluation/fix_score.h"
#include "core/io/trajectory.h"
#include "core/map/floor_map.h"

namespace floorloc {

/// truth_from_map by least squares over the map's own frames, so that it is independent of the evaluated poses. Throws
/// std::invalid_argument when the ground truth covers fewer than two frames.
Pose2 AlignMapToTruth(const std::vector<MapFrame>& frames, const Trajectory& ground_truth);

}  // namespace floorloc
