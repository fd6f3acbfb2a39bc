// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Pairs (query: of a, train: of b) of keypoints of two maps in one frame that are one floor point, by place, angle and
/// descriptor; each point in one pair at most. Descriptors must be of one kind. resolution_m: of the rectified
/// images.
std::vector<Match> FindSamePoints(const MapKeypoints& a, const MapKeypoints& b, double resolution_m);

}  // namespace floorloc
