// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Smooth errors that a camera calibration can have, as displacements of the raw image: six quadratic ones (tangential
/// distortion, shifted principal point), a cubic radial one, and two shears. Translation, rotation and scale are left
/// out: images cannot distinguish them from a motion of the robot and from the camera's height.
constexpr int kCalibrationModes = 9;

/// Displacement of a floor point per unit of each mode, base frame, metres. A unit displaces the corner of the region
/// of interest by one pixel.
using CalibrationJacobian = Eigen::Matrix<double, 2, kCalibrationModes>;

/// Interpolated bilinearly between the nodes of a grid over the region of interest.
class CalibrationModes {
 public:
  explicit CalibrationModes(const FloorCamera& camera);

  /// For the point where the calibration says that a pixel sees the floor; the nearest one of the region of interest
  /// for points outside of it. Zero where the camera does not see the floor.
  CalibrationJacobian At(const Eigen::Vector2d& point_in_base) const;

 private:
  const CalibrationJacobian& Node(int row, int column) const;

  RectM roi_;
  std::vector<CalibrationJacobian> nodes_;
};

}  // namespace floorloc
