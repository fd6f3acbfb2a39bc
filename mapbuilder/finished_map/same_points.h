// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Pairs (query: of a, train: of b) of keypoints of two maps in one frame that are the same floor point, by position,
/// angle and descriptor; each point is in at most one pair. Descriptors must be of one type. resolution_m: of the
/// rectified images.
std::vector<Match> FindSamePoints(const MapKeypoints& a, const MapKeypoints& b, double resolution_m);

}  // namespace floorloc
