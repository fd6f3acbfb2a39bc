// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Calibration parameters that can be wrong, in the order of CameraAdjustment. Rotation about the vertical is left out,
/// since it only rotates the base frame.
enum class CameraUnknown { kRoll, kPitch, kHeight, kFocal, kK1, kK2, kP1, kP2 };

constexpr int kCameraUnknowns = 8;

/// roll and pitch: rotation of the camera about the base's x and y axes, radians; height and focal length: relative
/// change; k1, k2: change of the first two radial distortion coefficients; p1, p2: of the tangential ones, which an
/// equidistant lens does not have (no effect).
using CameraAdjustment = Eigen::Matrix<double, kCameraUnknowns, 1>;
using CameraCovariance = Eigen::Matrix<double, kCameraUnknowns, kCameraUnknowns>;

/// The camera with changed mounting and lens: rays are rotated about the camera centre, which is raised. Exact, not
/// linearised.
FloorCamera Adjusted(const FloorCamera& camera, const CameraAdjustment& adjustment);

/// Jacobian of the floor point seen by a raw pixel with respect to the camera's unknowns, by central differences.
class AdjustmentDerivative {
 public:
  explicit AdjustmentDerivative(const FloorCamera& camera);
  Eigen::Matrix<double, 2, kCameraUnknowns> At(const Eigen::Vector2d& raw_px) const;

 private:
  std::array<FloorCamera, kCameraUnknowns> plus_;
  std::array<FloorCamera, kCameraUnknowns> minus_;
};

}  // namespace floorloc
