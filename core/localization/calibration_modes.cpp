// SPDX-License-Identifier: Apache-2.0
#include "core/localization/calibration_modes.h"

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

}  // namespace

CalibrationModes::CalibrationModes(const FloorCamera& camera)
    : camera_(camera), center_px_(camera.camera.cx, camera.camera.cy) {
  const RectM& roi = camera.floor.roi;
  const Eigen::Vector2d last(camera.camera.width_px - 1.0, camera.camera.height_px - 1.0);
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      const Eigen::Vector2d raw = camera.RawPixelFromFloor({x, y});
      if (raw.allFinite()) {
        const Eigen::Vector2d seen = raw.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(last);
        radius_px_ = std::max(radius_px_, (seen - center_px_).norm());
      }
    }
  }
}

CalibrationJacobian CalibrationModes::At(const Eigen::Vector2d& point_in_base) const {
  const double step_m = camera_.floor.resolution_m;
  const Eigen::Vector2d raw = camera_.RawPixelFromFloor(point_in_base);
  Eigen::Matrix2d raw_by_floor;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = step_m * Eigen::Vector2d::Unit(axis);
    raw_by_floor.col(axis) =
        (camera_.RawPixelFromFloor(point_in_base + step) - camera_.RawPixelFromFloor(point_in_base - step)) /
        (2.0 * step_m);
  }
  const CalibrationJacobian modes = raw_by_floor.inverse() * ImageModes((raw - center_px_) / radius_px_);
  return modes.allFinite() ? modes : CalibrationJacobian::Zero();
}

}  // namespace floorloc
