// SPDX-License-Identifier: Apache-2.0
#include "core/localization/camera_errors.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "core/geometry/mounting.h"

namespace floorloc {

std::size_t CameraKey(const FloorCamera& camera) {
  std::size_t key = 0;
  const auto add = [&](double value) { key = key * 1'000'003U + std::hash<double>()(value); };
  for (const double value : {camera.camera.fx, camera.camera.fy, camera.camera.cx, camera.camera.cy}) {
    add(value);
  }
  std::for_each(camera.camera.distortion.begin(), camera.camera.distortion.end(), add);
  std::for_each(camera.floor.base_from_pixel.data(), camera.floor.base_from_pixel.data() + 9, add);
  const RectM& roi = camera.floor.roi;
  for (const double value : {roi.x_min, roi.x_max, roi.y_min, roi.y_max}) {
    add(value);
  }
  return key;
}

double LargestDisplacementPx(const FloorCamera& camera, const CameraErrors& errors) {
  constexpr int kIntervals = 8;
  const CalibrationModes modes(camera);
  const Eigen::Vector3d center = camera.CameraCenter();
  const Eigen::Vector4d mounting(errors(0), errors(1), 0.0, errors(2));
  const RectM& roi = camera.floor.roi;
  std::vector<Eigen::Vector2d> moved;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int row = 0; row <= kIntervals; ++row) {
    for (int column = 0; column <= kIntervals; ++column) {
      const Eigen::Vector2d p(roi.x_min + roi.width_m() * column / kIntervals,
                              roi.y_min + roi.height_m() * row / kIntervals);
      moved.emplace_back(MountingJacobian(center, p) * mounting + modes.At(p) * errors.tail<kCalibrationModes>());
      mean += moved.back();
    }
  }
  mean /= static_cast<double>(moved.size());
  double largest_m = 0.0;
  for (const Eigen::Vector2d& d : moved) {
    largest_m = std::max(largest_m, (d - mean).norm());
  }
  return largest_m / camera.floor.resolution_m;
}

}  // namespace floorloc
