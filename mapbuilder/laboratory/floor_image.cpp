// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/floor_image.h"

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/vision/image/contrast.h"

namespace floorloc {

FloorImage FloorImage::FromGround(const GroundImage& image) {
  FloorImage floor_image{image.gray, image.mask, {}, {image.grid.x_top_m, image.grid.y_left_m}};
  floor_image.axes_m << 0.0, -image.grid.resolution_m, -image.grid.resolution_m, 0.0;
  return floor_image;
}

FloorImage FloorImage::FromMosaic(const cv::Mat& gray, const cv::Mat& mask, const Eigen::Vector2d& top_left_m,
                                  double resolution_m) {
  FloorImage floor_image{gray, mask, {}, top_left_m};
  floor_image.axes_m << resolution_m, 0.0, 0.0, -resolution_m;
  return floor_image;
}

double FloorImage::AreaM2() const { return cv::countNonZero(mask) * resolution_m() * resolution_m(); }

Keypoint FloorImage::ToFloor(const cv::KeyPoint& k) const {
  const Eigen::Vector2d position = FromPixel(k.pt.x, k.pt.y);
  const double angle_px = static_cast<double>(k.angle) * std::numbers::pi / 180.0;  // clockwise from +u
  const Eigen::Vector2d direction = axes_m * Eigen::Vector2d(std::cos(angle_px), std::sin(angle_px));
  return {static_cast<float>(position.x()), static_cast<float>(position.y()),
          static_cast<float>(std::atan2(direction.y(), direction.x())), static_cast<float>(k.size * resolution_m()),
          k.response};
}

FloorImage Normalized(const FloorImage& floor_image) {
  FloorImage normalized = floor_image;
  normalized.gray = NormalizeContrast(floor_image.gray, floor_image.mask, ContrastOptions());
  return normalized;
}

}  // namespace floorloc
