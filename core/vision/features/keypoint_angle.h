// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace floorloc {

/// Converts OpenCV's angle of a keypoint in a rectified image (degrees clockwise from the image's right, the base
/// frame's -y) to the base frame, radians.
inline float BaseAngle(float opencv_degrees) {
  const double angle_px = static_cast<double>(opencv_degrees) * std::numbers::pi / 180.0;
  return static_cast<float>(std::atan2(-std::cos(angle_px), -std::sin(angle_px)));
}

}  // namespace floorloc
