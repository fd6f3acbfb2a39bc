// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/floor_plane.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <stdexcept>

namespace floorloc {
namespace {

constexpr double kMaxRectifiedSidePx = 16384.0;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

constexpr int kGridSteps = 8;
using RoiGrid = std::array<Eigen::Vector2d, (kGridSteps + 1) * (kGridSteps + 1)>;

// Grid of points over a rectangle, including its corners and centre.
RoiGrid SpreadOver(const RectM& r) {
  RoiGrid points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t column = i % (kGridSteps + 1);
    const std::size_t row = i / (kGridSteps + 1);
    const double x = static_cast<double>(column) / kGridSteps;
    const double y = static_cast<double>(row) / kGridSteps;
    points[i] = {r.x_min + x * r.width_m(), r.y_min + y * r.height_m()};
  }
  return points;
}

// Sign of the homography's local area change at a pixel: a camera above the floor reverses the orientation (u right and
// v down; x forward and y left), so the determinant is negative in front of the horizon.
double LocalOrientation(const Eigen::Matrix3d& base_from_pixel, const Eigen::Vector2d& pixel) {
  const double w = base_from_pixel.row(2) * pixel.homogeneous();
  return base_from_pixel.determinant() / (w * w * w);
}

}  // namespace

void FloorPlane::Check() const {
  Require(base_from_pixel.allFinite(), "homography must have 9 finite numbers");
  // Relative to the norm of the matrix: a homography is defined up to scale.
  const double size = base_from_pixel.norm();
  Require(std::abs(base_from_pixel.determinant()) > 1e-15 * size * size * size, "homography is singular");
  Require(std::isfinite(roi.width_m()) && std::isfinite(roi.height_m()), "roi must be finite");
  Require(roi.width_m() > 0 && roi.height_m() > 0, "roi: x_min < x_max and y_min < y_max must hold");
  Require(std::isfinite(resolution_m) && resolution_m > 0, "resolution must be a positive number of metres per pixel");
  Require(roi.width_m() / resolution_m <= kMaxRectifiedSidePx && roi.height_m() / resolution_m <= kMaxRectifiedSidePx,
          "roi / resolution gives an image of more than 16384 pixels: is the resolution in metres per pixel?");
  Require(roi.width_m() / resolution_m >= 16 && roi.height_m() / resolution_m >= 16,
          "roi / resolution gives an image of less than 16 pixels: is the resolution in metres per pixel?");
  Require(std::isfinite(offset_sigma_m) && offset_sigma_m >= 0, "offset_sigma must be a number of metres, 0 or more");
}

void FloorCamera::Check() const {
  camera.Check();
  floor.Check();
  const Eigen::Matrix3d pixel_from_base = floor.base_from_pixel.inverse();
  const double w_center = pixel_from_base.row(2) * floor.roi.Center().homogeneous();
  bool any_visible = false;
  for (const Eigen::Vector2d& p : SpreadOver(floor.roi)) {
    const double w = pixel_from_base.row(2) * p.homogeneous();
    Require(w * w_center > 0, "roi crosses the horizon of the homography");
    const Eigen::Vector2d raw_px = RawPixelFromFloor(p);
    if (camera.Contains(raw_px)) {
      any_visible = true;
      Require((FloorFromRawPixel(raw_px) - p).norm() < 0.5 * floor.resolution_m,
              "roi reaches beyond the range of the lens model: make the roi smaller, or calibrate with a board that "
              "fills the image");
    }
  }
  Require(any_visible, "roi lies outside the image: homography, roi and camera_matrix do not belong together");
  const Eigen::Vector2d center_px = (pixel_from_base * floor.roi.Center().homogeneous()).hnormalized();
  Require(LocalOrientation(floor.base_from_pixel, center_px) < 0,
          "homography is mirrored: the base frame has x forward, y left, z up (are the axes swapped?)");
}

FloorCamera FloorCamera::AtResolution(double resolution_m) const {
  FloorCamera camera_at = *this;
  camera_at.floor.resolution_m = resolution_m;
  return camera_at;
}

FloorCamera FloorCamera::AtHeight(double ratio) const {
  Require(ratio > 0.0 && std::isfinite(ratio), "the ratio of heights must be a positive number");
  FloorCamera camera_at = *this;
  if (ratio == 1.0) {
    return camera_at;
  }
  const Eigen::Vector2d below = CameraCenter().head<2>();
  Eigen::Matrix3d scaling = Eigen::Vector3d(ratio, ratio, 1.0).asDiagonal();
  scaling.topRightCorner<2, 1>() = (1.0 - ratio) * below;
  camera_at.floor.base_from_pixel = scaling * floor.base_from_pixel;
  const auto scaled = [&](int axis, double metres) { return below[axis] + ratio * (metres - below[axis]); };
  camera_at.floor.roi = {scaled(0, floor.roi.x_min), scaled(0, floor.roi.x_max), scaled(1, floor.roi.y_min),
                         scaled(1, floor.roi.y_max)};
  return camera_at;
}

Eigen::Vector3d FloorCamera::CameraCenter() const {
  Eigen::Matrix3d intrinsics;
  intrinsics << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  // Proportional to [r1 r2 t] of camera_from_base.
  const Eigen::Matrix3d columns = (floor.base_from_pixel * intrinsics).inverse();
  const double depth = columns.row(2) * floor.roi.Center().homogeneous();
  const double norm = 0.5 * (columns.col(0).norm() + columns.col(1).norm());
  const Eigen::Matrix3d scaled = columns / std::copysign(norm, depth);
  const Eigen::Vector3d t = scaled.col(2);
  return {-scaled.col(0).dot(t), -scaled.col(1).dot(t), -scaled.col(0).cross(scaled.col(1)).dot(t)};
}

Eigen::Vector2d FloorCamera::FloorFromRawPixel(const Eigen::Vector2d& raw_px) const {
  return (floor.base_from_pixel * camera.Undistort(raw_px).homogeneous()).hnormalized();
}

Eigen::Vector2d FloorCamera::RawPixelFromFloor(const Eigen::Vector2d& point_in_base_m) const {
  const Eigen::Matrix3d pixel_from_base = floor.base_from_pixel.inverse();
  return camera.Distort((pixel_from_base * point_in_base_m.homogeneous()).hnormalized());
}

}  // namespace floorloc
