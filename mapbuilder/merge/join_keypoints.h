// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map/floor_map.h"

namespace floorloc {

/// Joins the keypoints of two maps in one frame, with one origin. A floor point in both becomes one: its position is
/// the mean weighted by observations, its descriptor that of the more often observed one. resolution_m: of the
/// rectified images. first_count: number of surveys of the first map, which come first.
MapKeypoints JoinKeypoints(const MapKeypoints& first, const MapKeypoints& second, double resolution_m, int first_count);

}  // namespace floorloc
