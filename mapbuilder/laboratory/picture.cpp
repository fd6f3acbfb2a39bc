// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/picture.h"

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/vision/image/contrast.h"

namespace floorloc {

FloorPicture FloorPicture::FromGround(const GroundImage& image) {
  FloorPicture picture{image.gray, image.mask, {}, {image.grid.x_top_m, image.grid.y_left_m}};
  picture.axes_m << 0.0, -image.grid.resolution_m, -image.grid.resolution_m, 0.0;
  return picture;
}

FloorPicture FloorPicture::FromMosaic(const cv::Mat& gray, const cv::Mat& mask, const Eigen::Vector2d& top_left_m,
                                      double resolution_m) {
  FloorPicture picture{gray, mask, {}, top_left_m};
  picture.axes_m << resolution_m, 0.0, 0.0, -resolution_m;
  return picture;
}

double FloorPicture::AreaM2() const { return cv::countNonZero(mask) * resolution_m() * resolution_m(); }

Keypoint FloorPicture::ToFloor(const cv::KeyPoint& k) const {
  const Eigen::Vector2d place = FromPixel(k.pt.x, k.pt.y);
  const double angle_px = static_cast<double>(k.angle) * std::numbers::pi / 180.0;  // clockwise from the right
  const Eigen::Vector2d direction = axes_m * Eigen::Vector2d(std::cos(angle_px), std::sin(angle_px));
  return {static_cast<float>(place.x()), static_cast<float>(place.y()),
          static_cast<float>(std::atan2(direction.y(), direction.x())), static_cast<float>(k.size * resolution_m()),
          k.response};
}

FloorPicture Normalized(const FloorPicture& picture) {
  FloorPicture normalized = picture;
  normalized.gray = NormalizeContrast(picture.gray, picture.mask, ContrastOptions());
  return normalized;
}

}  // namespace floorloc
