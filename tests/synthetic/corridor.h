// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/camera.h"

namespace floorloc {

/// A speckled corridor along +z: floor 1.2 m below, ceiling 1.3 m above, walls 2 m to either side, a wall at the end
/// 14 m away. Axes as a camera's: x right, y down. The same pose gives the same image, but for its noise.
class Corridor {
 public:
  explicit Corridor(const CameraModel& camera);

  /// 400x300, some barrel distortion.
  static CameraModel MakeCamera();

  /// Raw grey image, CV_8UC1, with noise of 1.5 grey values.
  cv::Mat View(const Eigen::Isometry3d& world_from_camera, int noise_seed) const;

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector3d> rays_;  // of every raw pixel, z = 1
};

}  // namespace floorloc
