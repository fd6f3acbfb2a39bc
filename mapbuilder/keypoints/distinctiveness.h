// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

struct DistinctivenessOptions {
  double same_place_m = 0.03;  ///< nearer keypoints are no rivals: confusing them does little harm
  int threads = 0;             ///< 0: one per core
  std::uint32_t seed = 1;
};

/// How distinctive each keypoint is in the map: the distance of its descriptor to the nearest one of another place, as
/// a share of the distance that two keypoints of the map have on the average (255: that far or farther, 0: it has a
/// duplicate). An index seeks the neighbours with bounded work per keypoint, so that the time is nearly linear: a rival
/// may be missed, seldom one that is nearly equal.
std::vector<std::uint8_t> MeasureDistinctiveness(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors,
                                                 const DistinctivenessOptions& options);

}  // namespace floorloc
