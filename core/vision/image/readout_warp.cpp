// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/readout_warp.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {
namespace {

// Nodes of the grid of displacements. They vary as slowly as the lens' magnification does.
constexpr int kNodePx = 16;
constexpr int kFractions = cv::INTER_TAB_SIZE;  // of a pixel
constexpr short kUnseen = -2;

// A camera whose homography is inverted once.
class MovingCamera {
 public:
  MovingCamera(const FloorCamera& camera, const Eigen::Vector3d& motion)
      : camera_(camera.camera), pixel_from_base_(camera.floor.base_from_pixel.inverse()), motion_(motion) {}

  Eigen::Vector2d AtRest(const Eigen::Vector2d& point) const {
    return camera_.Distort((pixel_from_base_ * point.homogeneous()).hnormalized());
  }

  // Fixed point: which row sees the point depends on when it does. Each step shrinks the error by the share of the view
  // that the robot passes during the read-out.
  Eigen::Vector2d Moving(const Eigen::Vector2d& point) const {
    constexpr int kMaxSteps = 8;
    constexpr double kTolerancePx2 = 1e-6;
    Eigen::Vector2d raw = AtRest(point);
    for (int i = 0; i < kMaxSteps; ++i) {
      const Eigen::Vector2d next = AtRest(Pose2::Exp(-ReadoutShare(camera_, raw) * motion_) * point);
      const bool converged = (next - raw).squaredNorm() < kTolerancePx2;
      raw = next;
      if (converged) {
        break;
      }
    }
    return raw;
  }

 private:
  const CameraModel& camera_;
  Eigen::Matrix3d pixel_from_base_;
  Eigen::Vector3d motion_;
};

// Displacements of raw pixels at nodes, in fractions of a pixel: CV_32FC2.
cv::Mat NodeDisplacements(const MovingCamera& camera, const GroundGrid& grid) {
  cv::Mat nodes((grid.height_px + kNodePx - 2) / kNodePx + 1, (grid.width_px + kNodePx - 2) / kNodePx + 1, CV_32FC2);
  for (int v = 0; v < nodes.rows; ++v) {
    for (int u = 0; u < nodes.cols; ++u) {
      const Eigen::Vector2d point = grid.BaseFromPixel(kNodePx * u, kNodePx * v);
      const Eigen::Vector2d moved = kFractions * (camera.Moving(point) - camera.AtRest(point));
      nodes.at<cv::Vec2f>(v, u) =
          moved.allFinite() ? cv::Vec2f(static_cast<float>(moved.x()), static_cast<float>(moved.y())) : cv::Vec2f();
    }
  }
  return nodes;
}

// Row v of the displacements, at every pixel.
std::vector<cv::Vec2f> RowOf(const cv::Mat& nodes, int v, int width) {
  const int above = std::min(v / kNodePx, nodes.rows - 1);
  const int below = std::min(above + 1, nodes.rows - 1);
  const float down = static_cast<float>(v - above * kNodePx) / kNodePx;
  const auto node = [&](int u) {
    return nodes.at<cv::Vec2f>(above, u) * (1.0F - down) + nodes.at<cv::Vec2f>(below, u) * down;
  };
  std::vector<cv::Vec2f> row(static_cast<std::size_t>(width));
  cv::Vec2f left = node(0);
  for (int u = 0; u < nodes.cols && u * kNodePx < width; ++u) {
    const cv::Vec2f right = node(std::min(u + 1, nodes.cols - 1));
    const cv::Vec2f step = (right - left) * (1.0F / kNodePx);
    for (int i = 0; i < std::min(kNodePx, width - u * kNodePx); ++i) {
      const int column = u * kNodePx + i;
      row[static_cast<std::size_t>(column)] = left + step * static_cast<float>(i);
    }
    left = right;
  }
  return row;
}

}  // namespace

double ReadoutShare(const CameraModel& camera, const Eigen::Vector2d& raw_px) {
  const double share = camera.readout.ByColumns() ? (raw_px.x() + 0.5) / camera.width_px - 0.5
                                                  : (raw_px.y() + 0.5) / camera.height_px - 0.5;
  // Points outside of the image only lie beside nodes that are inside.
  return camera.readout.Sign() * std::clamp(share, -1.0, 1.0);
}

Eigen::Vector2d RawPixelWhileMoving(const FloorCamera& camera, const Eigen::Vector2d& point_in_base,
                                    const Eigen::Vector3d& motion) {
  return motion.isZero() ? camera.RawPixelFromFloor(point_in_base) : MovingCamera(camera, motion).Moving(point_in_base);
}

Eigen::Vector2d FloorWhileMoving(const FloorCamera& camera, const Eigen::Vector2d& raw_px,
                                 const Eigen::Vector3d& motion) {
  return Pose2::Exp(ReadoutShare(camera.camera, raw_px) * motion) * camera.FloorFromRawPixel(raw_px);
}

PixelMap MoveRows(const FloorCamera& camera, const GroundGrid& grid, const PixelMap& at_rest,
                  const Eigen::Vector3d& motion) {
  const cv::Mat nodes = NodeDisplacements(MovingCamera(camera, motion), grid);
  const int last_x = kFractions * (camera.camera.width_px - 1);
  const int last_y = kFractions * (camera.camera.height_px - 1);
  PixelMap moved{cv::Mat(at_rest.xy.size(), CV_16SC2), cv::Mat(at_rest.xy.size(), CV_16UC1)};
  for (int v = 0; v < moved.xy.rows; ++v) {
    const std::vector<cv::Vec2f> by = RowOf(nodes, v, moved.xy.cols);
    const auto* from = at_rest.xy.ptr<cv::Vec2s>(v);
    const auto* from_index = at_rest.fraction.ptr<std::uint16_t>(v);
    auto* to = moved.xy.ptr<cv::Vec2s>(v);
    auto* to_index = moved.fraction.ptr<std::uint16_t>(v);
    for (std::size_t u = 0; u < by.size(); ++u) {
      const int x = kFractions * from[u][0] + from_index[u] % kFractions + cvRound(by[u][0]);
      const int y = kFractions * from[u][1] + from_index[u] / kFractions + cvRound(by[u][1]);
      const bool seen = from[u][0] != kUnseen && x >= 0 && y >= 0 && x <= last_x && y <= last_y;
      to[u] = seen ? cv::Vec2s(static_cast<short>(x / kFractions), static_cast<short>(y / kFractions))
                   : cv::Vec2s(kUnseen, kUnseen);
      to_index[u] = static_cast<std::uint16_t>(seen ? (y % kFractions) * kFractions + x % kFractions : 0);
    }
  }
  return moved;
}

}  // namespace floorloc
