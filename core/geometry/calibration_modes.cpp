// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/calibration_modes.h"

#include <Eigen/LU>
#include <algorithm>

namespace floorloc {
namespace {

// Displacements of the raw image at q, the position relative to the principal point in units of the farthest corner.
CalibrationJacobian ImageModes(const Eigen::Vector2d& q) {
  const double xx = q.x() * q.x(), xy = 2.0 * q.x() * q.y(), yy = q.y() * q.y();
  const Eigen::Vector2d radial = q.squaredNorm() * q;
  CalibrationJacobian modes;
  modes << xx, xy, yy, 0.0, 0.0, 0.0, radial.x(), q.x(), q.y(), 0.0, 0.0, 0.0, xx, xy, yy, radial.y(), -q.y(), q.x();
  return modes;
}

constexpr int kIntervals = 16;

// Radius of the farthest corner of the region of interest that the image shows, about the principal point.
double RadiusPx(const FloorCamera& camera) {
  const RectM& roi = camera.floor.roi;
  const Eigen::Vector2d last(camera.camera.width_px - 1.0, camera.camera.height_px - 1.0);
  double radius_px = 1.0;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      const Eigen::Vector2d raw = camera.RawPixelFromFloor({x, y});
      if (raw.allFinite()) {
        const Eigen::Vector2d seen = raw.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(last);
        radius_px = std::max(radius_px, (seen - Eigen::Vector2d(camera.camera.cx, camera.camera.cy)).norm());
      }
    }
  }
  return radius_px;
}

CalibrationJacobian ModesAt(const FloorCamera& camera, double radius_px, const Eigen::Vector2d& point_in_base) {
  const double step_m = camera.floor.resolution_m;
  const Eigen::Vector2d raw = camera.RawPixelFromFloor(point_in_base);
  Eigen::Matrix2d raw_by_floor;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = step_m * Eigen::Vector2d::Unit(axis);
    raw_by_floor.col(axis) =
        (camera.RawPixelFromFloor(point_in_base + step) - camera.RawPixelFromFloor(point_in_base - step)) /
        (2.0 * step_m);
  }
  const Eigen::Vector2d center(camera.camera.cx, camera.camera.cy);
  const CalibrationJacobian modes = raw_by_floor.inverse() * ImageModes((raw - center) / radius_px);
  return modes.allFinite() ? modes : CalibrationJacobian::Zero();
}

}  // namespace

CalibrationModes::CalibrationModes(const FloorCamera& camera) : roi_(camera.floor.roi) {
  const double radius_px = RadiusPx(camera);
  for (int row = 0; row <= kIntervals; ++row) {
    for (int column = 0; column <= kIntervals; ++column) {
      nodes_.push_back(ModesAt(
          camera, radius_px,
          {roi_.x_min + roi_.width_m() * column / kIntervals, roi_.y_min + roi_.height_m() * row / kIntervals}));
    }
  }
}

const CalibrationJacobian& CalibrationModes::Node(int row, int column) const {
  return nodes_[static_cast<std::size_t>(row) * (kIntervals + 1) + static_cast<std::size_t>(column)];
}

CalibrationJacobian CalibrationModes::At(const Eigen::Vector2d& point_in_base) const {
  const double u = std::clamp((point_in_base.x() - roi_.x_min) / roi_.width_m(), 0.0, 1.0) * kIntervals;
  const double v = std::clamp((point_in_base.y() - roi_.y_min) / roi_.height_m(), 0.0, 1.0) * kIntervals;
  const int column = std::min(static_cast<int>(u), kIntervals - 1);
  const int row = std::min(static_cast<int>(v), kIntervals - 1);
  const double a = u - column;
  const double b = v - row;
  return (1.0 - b) * ((1.0 - a) * Node(row, column) + a * Node(row, column + 1)) +
         b * ((1.0 - a) * Node(row + 1, column) + a * Node(row + 1, column + 1));
}

}  // namespace floorloc
