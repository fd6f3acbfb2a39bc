// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map/floor_map.h"

namespace floorloc {

/// The keypoints of two maps in one frame as those of one map: a floor point that both have becomes one, its place the
/// mean by the numbers of observations, its descriptor that of the more often observed. resolution_m: of the rectified
/// images. first_count: surveys of the first map, whose numbers come first.
MapKeypoints JoinKeypoints(const MapKeypoints& first, const MapKeypoints& second, double resolution_m, int first_count);

}  // namespace floorloc
