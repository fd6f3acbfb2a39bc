// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/upright_image.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/vision/extractors/steered_brief.h"

namespace floorloc {

cv::Mat DescribeUpright(const UprightImage& image, std::span<const Keypoint> keypoints, double map_from_base_yaw_rad) {
  std::vector<cv::Point2f> points;
  points.reserve(keypoints.size());
  for (const Keypoint& k : keypoints) {
    const Eigen::Vector2f p = image.grid.PixelFromBase(k.Position()).cast<float>();
    points.emplace_back(p.x(), p.y());
  }
  // The map's +x lies at -yaw in the base frame, whose +x is up and +y left in the image.
  const double angle = std::atan2(-std::cos(map_from_base_yaw_rad), std::sin(map_from_base_yaw_rad));
  return DescribeBriefAt(image.smooth, points, static_cast<float>(angle * 180.0 / std::numbers::pi));
}

}  // namespace floorloc
