// SPDX-License-Identifier: Apache-2.0
#include "tests/synthetic/corridor.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>

namespace floorloc {
namespace {

struct Wall {
  int axis;        // the coordinate that is constant on the plane
  double place_m;  // its value
};
constexpr Wall kWalls[] = {{1, 1.2}, {1, -1.3}, {0, -2.0}, {0, 2.0}, {2, 14.0}};

double RandomAt(std::int64_t x, std::int64_t y, std::uint64_t layer) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^ layer * 0x165667B19E3779F9ULL;
  h = (h ^ (h >> 31)) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

// Value noise in [0, 1].
double Noise(double u, double v, std::uint64_t layer) {
  const double u0 = std::floor(u);
  const double v0 = std::floor(v);
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const auto at = [&](int du, int dv) {
    return RandomAt(static_cast<std::int64_t>(u0) + du, static_cast<std::int64_t>(v0) + dv, layer);
  };
  const double a = smooth(u - u0);
  const double b = smooth(v - v0);
  return std::lerp(std::lerp(at(0, 0), at(1, 0), a), std::lerp(at(0, 1), at(1, 1), a), b);
}

double Brightness(const Eigen::Vector3d& point, int wall) {
  const int axis = kWalls[wall].axis;
  const double u = point[(axis + 1) % 3];
  const double v = point[(axis + 2) % 3];
  const auto layer = 3 * static_cast<std::uint64_t>(wall);
  return 20.0 + 90.0 * Noise(u / 0.12, v / 0.12, layer) + 70.0 * Noise(u / 0.3, v / 0.3, layer + 1) +
         40.0 * Noise(u / 0.9, v / 0.9, layer + 2);
}

}  // namespace

Corridor::Corridor(const CameraModel& camera) : camera_(camera) {
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector2d px = camera.Undistort({u, v});
      rays_.emplace_back((px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy, 1.0);
    }
  }
}

CameraModel Corridor::MakeCamera() {
  CameraModel camera;
  camera.name = "corridor";
  camera.width_px = 400;
  camera.height_px = 300;
  camera.fx = camera.fy = 260.0;
  camera.cx = 199.5;
  camera.cy = 149.5;
  camera.distortion = {-0.1, 0.01, 0.0, 0.0, 0.0};
  return camera;
}

cv::Mat Corridor::View(const Eigen::Isometry3d& world_from_camera, int noise_seed) const {
  cv::Mat gray(camera_.height_px, camera_.width_px, CV_8UC1);
  cv::RNG random(static_cast<std::uint64_t>(noise_seed) + 1);
  const Eigen::Vector3d camera_center = world_from_camera.translation();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Eigen::Vector3d ray = world_from_camera.rotation() * rays_[i];
    double nearest = std::numeric_limits<double>::infinity();
    int hit = 0;
    for (int wall = 0; wall < 5; ++wall) {
      const double along = (kWalls[wall].place_m - camera_center[kWalls[wall].axis]) / ray[kWalls[wall].axis];
      if (along > 0.0 && along < nearest) {
        nearest = along;
        hit = wall;
      }
    }
    const bool open = !std::isfinite(nearest);  // the ray leaves through the open end
    const double value = open ? 0.0 : Brightness(camera_center + nearest * ray, hit);
    gray.data[i] = cv::saturate_cast<unsigned char>(value + random.gaussian(1.5));
  }
  return gray;
}

}  // namespace floorloc
