// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// How good a square of the floor is for localization.
struct QualityCell {
  int x = 0;  ///< of the square's lower left corner, in squares from the map's (0, 0)
  int y = 0;
  int keypoints = 0;
  double observations = 0.0;     ///< mean number of survey frames that saw a keypoint
  double distinctiveness = 0.0;  ///< mean, 0: equal to other places of the map, 1: as far from them as random ones
};

/// The squares that have keypoints, sorted by y, then x. cell_m: their side, metres.
std::vector<QualityCell> MeasureQuality(const MapKeypoints& keypoints, double cell_m);

}  // namespace floorloc
