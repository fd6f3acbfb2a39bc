// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/camera_errors.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/geometry/mounting.h"
#include "core/map/content_hash.h"

namespace floorloc {

std::size_t CameraKey(const FloorCamera& camera) {
  ContentHash hash;
  const CameraModel& c = camera.camera;
  hash.Add(std::int64_t{c.width_px}).Add(std::int64_t{c.height_px});
  hash.Add(std::string(ToString(c.distortion_model)));
  hash.Add(c.readout.seconds.value_or(-1.0)).Add(std::string(ToString(c.readout.direction)));
  hash.Add(std::string(ToString(c.readout.stamp_at)));
  const auto add = [&](double value) { hash.Add(value); };
  const RectM& roi = camera.floor.roi;
  for (const double value : {c.fx, c.fy, c.cx, c.cy, roi.x_min, roi.x_max, roi.y_min, roi.y_max}) {
    add(value);
  }
  std::for_each(c.distortion.begin(), c.distortion.end(), add);
  std::for_each(camera.floor.base_from_pixel.data(), camera.floor.base_from_pixel.data() + 9, add);
  return static_cast<std::size_t>(hash.Checksum());
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
