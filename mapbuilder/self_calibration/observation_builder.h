// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/self_calibration/bundle_adjustment.h"
#include "mapbuilder/self_calibration/camera_adjustment.h"

namespace floorloc {

/// Derivative of floor points with respect to the camera, interpolated between the nodes of a grid over the region of
/// interest: it is smooth, and exact values cost sixteen inversions of the lens model.
class DerivativeGrid {
 public:
  using Jacobian = Eigen::Matrix<double, 2, kCameraUnknowns>;

  explicit DerivativeGrid(const FloorCamera& camera);

  /// Exact outside the region of interest. point_in_base: metres.
  Jacobian At(const Eigen::Vector2d& point_in_base) const;

 private:
  Jacobian Exact(const Eigen::Vector2d& point_in_base) const {
    return derivative_.At(camera_.RawPixelFromFloor(point_in_base));
  }
  const Jacobian& Node(int row, int column) const;

  FloorCamera camera_;
  AdjustmentDerivative derivative_;
  std::vector<Jacobian> nodes_;
};

/// Builds the observations of one survey's camera.
class ObservationBuilder {
 public:
  explicit ObservationBuilder(const FloorCamera& camera);

  /// point_in_base: metres, as the camera at the frame's own height has it, a multiple of the calibrated one.
  Observation Make(int frame, const Eigen::Vector2d& point_in_base, double height_ratio) const;
  const FloorCamera& camera() const { return camera_; }

 private:
  FloorCamera camera_;
  DerivativeGrid derivative_;
  Eigen::Vector3d center_;
};

}  // namespace floorloc
