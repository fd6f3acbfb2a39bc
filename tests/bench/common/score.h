// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/evaluation/fix_score.h"
#include "core/io/trajectory.h"
#include "core/map/floor_map.h"

namespace floorloc {

/// The rigid motion from the map's frame to the truth's, by least squares over the map's own frames, so that it does
/// not depend on the answers that are judged. Throws std::invalid_argument when fewer than two frames have a truth.
Pose2 AlignMapToTruth(const std::vector<MapFrame>& frames, const Trajectory& ground_truth);

}  // namespace floorloc
