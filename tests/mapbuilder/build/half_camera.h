// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry/floor_plane.h"
#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

/// The downward camera at half the resolution: surveys take a quarter of the time.
inline FloorCamera HalfCamera() {
  FloorCamera half = MakeDownwardCamera();
  half.camera.width_px = 320;
  half.camera.height_px = 240;
  half.camera.fx *= 0.5;
  half.camera.fy *= 0.5;
  half.camera.cx = 0.5 * (half.camera.cx + 0.5) - 0.5;
  half.camera.cy = 0.5 * (half.camera.cy + 0.5) - 0.5;
  Eigen::Matrix3d full_from_half;
  full_from_half << 2.0, 0.0, 0.5, 0.0, 2.0, 0.5, 0.0, 0.0, 1.0;
  half.floor.base_from_pixel = half.floor.base_from_pixel * full_from_half;
  half.floor.resolution_m *= 2.0;
  return half;
}

}  // namespace floorloc
