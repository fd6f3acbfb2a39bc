// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/camera.h"

namespace floorloc {

/// A textured corridor along +z: floor 1.2 m below, ceiling 1.3 m above, walls 2 m to either side, end wall at 14 m.
/// Camera axes: x right, y down, z forward. Equal poses and seeds give equal images.
class Corridor {
 public:
  explicit Corridor(const CameraModel& camera);

  /// 400x300, with barrel distortion.
  static CameraModel MakeCamera();

  /// Raw grey image, CV_8UC1, with noise of 1.5 grey values.
  cv::Mat View(const Eigen::Isometry3d& world_from_camera, int noise_seed) const;

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector3d> rays_;  // one per raw pixel, on z = 1
};

}  // namespace floorloc
