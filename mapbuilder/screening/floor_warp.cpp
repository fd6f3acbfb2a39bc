// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/floor_warp.h"

#include <cmath>

namespace floorloc {
namespace {

constexpr int kNodePx = 8;
constexpr float kOutside = -1e6F;

// Nodes beside the image are needed for pixels at its edge: distance from its centre, as a share of its size.
constexpr double kExtrapolated = 0.6;

// Floor farther from the centre of the region of interest than this share of its size is not looked at.
constexpr double kReach = 0.75;

const Eigen::Vector2d kNowhere = Eigen::Vector2d::Constant(std::nan(""));

}  // namespace

FloorWarp::FloorWarp(const FloorCamera& camera, const cv::Size& size)
    : camera_(camera),
      size_(size),
      scale_(static_cast<double>(camera.camera.width_px) / size.width,
             static_cast<double>(camera.camera.height_px) / size.height),
      columns_((size.width - 1) / kNodePx + 2),
      rows_((size.height - 1) / kNodePx + 2) {
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      floor_.push_back(FloorAt(column * kNodePx, row * kNodePx));
    }
  }
}

cv::Mat FloorWarp::MapFor(const Pose2& other_from_this) const {
  std::vector<cv::Vec2f> nodes;
  nodes.reserve(floor_.size());
  for (const Eigen::Vector2d& point : floor_) {
    nodes.push_back(PixelOf(other_from_this * point));
  }
  cv::Mat map(size_, CV_32FC2);
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u) {
      const int node = v / kNodePx * columns_ + u / kNodePx;
      const cv::Vec2f* upper = &nodes[static_cast<std::size_t>(node)];
      const cv::Vec2f* lower = upper + columns_;
      const float a = static_cast<float>(u % kNodePx) / kNodePx;
      const float b = static_cast<float>(v % kNodePx) / kNodePx;
      map.at<cv::Vec2f>(v, u) =
          (1.0F - b) * ((1.0F - a) * upper[0] + a * upper[1]) + b * ((1.0F - a) * lower[0] + a * lower[1]);
    }
  }
  return map;
}

Eigen::Vector2d FloorWarp::FloorAt(int u, int v) const {
  const Eigen::Vector2d raw = (Eigen::Vector2d(u, v).array() + 0.5) * scale_.array() - 0.5;
  const Eigen::Vector2d point = camera_.FloorFromRawPixel(raw);
  const RectM& roi = camera_.floor.roi;
  const Eigen::Vector2d reach = kReach * Eigen::Vector2d(roi.width_m(), roi.height_m());
  return ((point - roi.Center()).cwiseAbs().array() <= reach.array()).all() ? point : kNowhere;
}

cv::Vec2f FloorWarp::PixelOf(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d raw = point.allFinite() ? camera_.RawPixelFromFloor(point) : kNowhere;
  const Eigen::Vector2d size(camera_.camera.width_px, camera_.camera.height_px);
  if (!raw.allFinite() || ((raw - 0.5 * size).cwiseAbs().array() > kExtrapolated * size.array()).any()) {
    return {kOutside, kOutside};
  }
  const Eigen::Vector2d px = (raw.array() + 0.5) / scale_.array() - 0.5;
  return {static_cast<float>(px.x()), static_cast<float>(px.y())};
}

}  // namespace floorloc
