// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Looks straight down 0.2 m in front of the base: 640x480, plumb_bob. At 0.4 m height: view 0.31 x 0.415 m, 0.7 mm/px.
FloorCamera MakeDownwardCamera(double height_m = 0.4);
/// Looks forward, 50 degrees below the horizon: 640x480, plumb_bob. At 0.35 m height: 0.39 x 0.365 m, 0.8 mm/px.
FloorCamera MakeForwardCamera(double height_m = 0.35);
/// Looks straight down through a fisheye lens: 640x480, equidistant. At 0.3 m height: 0.34 x 0.44 m, 0.8 mm/px.
FloorCamera MakeEquidistantCamera(double height_m = 0.3);

/// Deviation of the camera's pose from its calibration, as on a bumpy floor.
struct CameraVibration {
  double pitch_rad = 0.0;  ///< about the base's y axis
  double roll_rad = 0.0;   ///< about the base's x axis
  double height_m = 0.0;   ///< up
};

/// FloorPlane::base_from_pixel of the displaced camera. The calibrated pose is recovered from the homography.
Eigen::Matrix3d VibratedBaseFromPixel(const FloorCamera& camera, const CameraVibration& vibration);

}  // namespace floorloc
