// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "core/vision/features/features.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// A rectified image as upright BRIEF is computed in (U-SURF's idea, Bay, Ess, Tuytelaars & Van Gool 2008: where the
/// heading is known, a keypoint's own orientation only adds errors; `./run bench descriptors` has the numbers).
struct UprightImage {
  GroundGrid grid;
  cv::Mat smooth;  ///< CV_16SC1, of the grid's size; empty: no upright descriptors

  bool empty() const { return smooth.empty(); }
};

/// Descriptors of the keypoints (base frame) as if the image had been taken with the base's axes parallel to those of
/// the map: CV_8U, one row of kBriefBytes each. map_from_base_yaw_rad: heading of the base in the map. Of keypoints
/// nearer than kBriefReachPx to the edge all bits are 0.
cv::Mat DescribeUpright(const UprightImage& image, std::span<const Keypoint> keypoints, double map_from_base_yaw_rad);

}  // namespace floorloc
