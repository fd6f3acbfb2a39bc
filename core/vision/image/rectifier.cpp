// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/rectifier.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {

GroundGrid GroundGrid::FromFloor(const FloorPlane& floor) {
  GroundGrid grid;
  grid.resolution_m = floor.resolution_m;
  grid.width_px = static_cast<int>(std::lround(floor.roi.height_m() / floor.resolution_m));
  grid.height_px = static_cast<int>(std::lround(floor.roi.width_m() / floor.resolution_m));
  grid.x_top_m = floor.roi.x_max - 0.5 * floor.resolution_m;
  grid.y_left_m = floor.roi.y_max - 0.5 * floor.resolution_m;
  return grid;
}

GroundImage LeaveOut(const GroundImage& image, const cv::Mat& left_out) {
  if (left_out.empty()) {
    return image;
  }
  cv::Mat kept;
  cv::resize(left_out, kept, image.mask.size(), 0, 0, cv::INTER_NEAREST);
  kept = (kept == 0) & image.mask;
  return {image.grid, image.gray & kept, kept};
}

namespace {

const FloorCamera& Checked(const FloorCamera& camera) {
  camera.Check();
  return camera;
}

}  // namespace

Rectifier::Rectifier(const FloorCamera& camera, const cv::Mat& raw_mask)
    : camera_(Checked(camera)),
      calibration_modes_(camera_),
      raw_mask_(raw_mask.empty() ? cv::Mat() : cv::Mat(raw_mask > 0)) {
  grid_ = GroundGrid::FromFloor(camera_.floor);
  const cv::Size size(grid_.width_px, grid_.height_px);
  cv::Mat map(size, CV_32FC2);
  mask_ = cv::Mat(size, CV_8UC1, cv::Scalar(0));
  const Eigen::Matrix3d pixel_from_base = camera_.floor.base_from_pixel.inverse();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const Eigen::Vector2d floor_point = grid_.BaseFromPixel(u, v);
      const Eigen::Vector2d raw = camera_.camera.Distort((pixel_from_base * floor_point.homogeneous()).hnormalized());
      const bool seen = raw.allFinite() && camera_.camera.Contains(raw);
      map.at<cv::Vec2f>(v, u) = seen ? cv::Vec2f(static_cast<float>(raw.x()), static_cast<float>(raw.y()))
                                     : cv::Vec2f(-2.0F, -2.0F);  // outside: the border value
      mask_.at<std::uint8_t>(v, u) = seen ? 255 : 0;
    }
  }
  cv::convertMaps(map, cv::noArray(), map_.xy, map_.fraction, CV_16SC2);
  if (!raw_mask_.empty()) {
    ApplyMask();
  }
}

void Rectifier::ApplyMask() {
  if (raw_mask_.type() != CV_8UC1) {
    throw std::invalid_argument("the mask is not grey");
  }
  const int seen = cv::countNonZero(mask_);
  // Pixels that mix with what is masked do not count.
  mask_ &= RectifyImage(raw_mask_) == 255;
  masked_share_ = seen > 0 ? 1.0 - static_cast<double>(cv::countNonZero(mask_)) / seen : 0.0;
}

cv::Mat Rectifier::Remap(const cv::Mat& raw, const PixelMap& map) const {
  if (raw.depth() != CV_8U || raw.cols != camera_.camera.width_px || raw.rows != camera_.camera.height_px) {
    throw std::invalid_argument("the image is not an 8-bit image of the calibrated camera's size");
  }
  cv::Mat rectified;
  cv::remap(raw, rectified, map.xy, map.fraction, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return rectified;
}

cv::Mat Rectifier::RectifyImage(const cv::Mat& raw) const { return Remap(raw, map_); }

GroundImage Rectifier::Rectify(const cv::Mat& raw) const { return Rectify(raw, Eigen::Vector3d::Zero()); }

GroundImage Rectifier::Rectify(const cv::Mat& raw, const Eigen::Vector3d& motion) const {
  return Rectify(raw, cv::Rect(0, 0, grid_.width_px, grid_.height_px), motion);
}

GroundImage Rectifier::Rectify(const cv::Mat& raw, const cv::Rect& part, const Eigen::Vector3d& motion) const {
  if (raw.channels() != 1) {
    throw std::invalid_argument("the image is not grey");
  }
  GroundImage image{grid_, cv::Mat(), mask_(part)};
  const Eigen::Vector2d top_left = grid_.BaseFromPixel(part.x, part.y);
  image.grid.x_top_m = top_left.x();
  image.grid.y_left_m = top_left.y();
  image.grid.width_px = part.width;
  image.grid.height_px = part.height;
  PixelMap map{map_.xy(part), map_.fraction(part)};
  if (!motion.isZero()) {
    map = MoveRows(camera_, image.grid, map, motion);
    image.mask = cv::Mat();
    cv::extractChannel(map.xy, image.mask, 0);
    image.mask = image.mask >= 0;
    if (!raw_mask_.empty()) {
      image.mask &= Remap(raw_mask_, map) == 255;
    }
  }
  image.gray = Remap(raw, map);
  if (!raw_mask_.empty()) {
    image.gray &= image.mask;
  }
  return image;
}

}  // namespace floorloc
