// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/batch/run_options.h"

namespace floorloc {

struct DistinctivenessOptions {
  double same_place_m = 0.03;  ///< nearer keypoints are ignored: confusing them does little harm
  RunOptions run;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Distinctiveness of each keypoint in the map: the distance of its descriptor to the nearest one at another place,
/// relative to the mean distance of two keypoints of the map (255: that far or farther, 0: it has a duplicate). An
/// approximate index bounds the work per keypoint, so that the time is nearly linear; it may miss the nearest
/// neighbour, but rarely one that is nearly equal.
std::vector<std::uint8_t> MeasureDistinctiveness(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors,
                                                 const DistinctivenessOptions& options);

}  // namespace floorloc
