// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// What can be wrong with a camera's calibration, in the order of CameraAdjustment. The rotation about the plumb line
/// is left out: it only turns the base frame.
enum class CameraUnknown { kRoll, kPitch, kHeight, kFocal, kK1, kK2 };

constexpr int kCameraUnknowns = 6;

/// roll and pitch: rotation of the camera about the base's x and y axis, radians; height and focal length: change as a
/// share; k1, k2: change of the first two distortion coefficients.
using CameraAdjustment = Eigen::Matrix<double, kCameraUnknowns, 1>;

/// The camera with other mounting and lens: the rays that its pixels see turn about the camera's centre, the centre
/// rises. Exact, not to first order.
FloorCamera Adjusted(const FloorCamera& camera, const CameraAdjustment& adjustment);

/// Derivatives of where raw pixels see the floor with respect to a camera's unknowns, by central differences.
class AdjustmentDerivative {
 public:
  explicit AdjustmentDerivative(const FloorCamera& camera);
  Eigen::Matrix<double, 2, kCameraUnknowns> At(const Eigen::Vector2d& raw_px) const;

 private:
  std::array<FloorCamera, kCameraUnknowns> plus_;
  std::array<FloorCamera, kCameraUnknowns> minus_;
};

}  // namespace floorloc
