// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/camera_doubt.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/map/camera_correction.h"

namespace floorloc {
namespace {

using Complex = std::complex<double>;

Complex ToComplex(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

// A point of the map as it is, and as it would be.
struct MovedPoint {
  Complex from, to;
};

// Distances that are left after the best similarity.
std::vector<double> Misfits(const std::vector<MovedPoint>& points) {
  MovedPoint mean;
  for (const MovedPoint& p : points) {
    mean.from += p.from / static_cast<double>(points.size());
    mean.to += p.to / static_cast<double>(points.size());
  }
  Complex along;
  double spread = 0.0;
  for (const MovedPoint& p : points) {
    along += std::conj(p.from - mean.from) * (p.to - mean.to);
    spread += std::norm(p.from - mean.from);
  }
  const Complex factor = spread > 0.0 ? along / spread : Complex(1.0, 0.0);
  std::vector<double> misfits;
  for (const MovedPoint& p : points) {
    misfits.push_back(std::abs(factor * (p.from - mean.from) - (p.to - mean.to)));
  }
  return misfits;
}

double Rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) {
    squares += value * value;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

// Centres of the views, on the floor and fixed to the base.
struct Moved {
  std::vector<MovedPoint> views, poses;
};

Moved CollectMoved(const CalibratedFrames& map, const CalibratedFrames& other) {
  Moved moved;
  for (std::size_t i = 0; i < map.set.frames.size(); ++i) {
    const auto& before = map.placement.map_from_base[i];
    const auto& after = other.placement.map_from_base[i];
    if (before && after) {
      const FloorCamera given = CameraOf(map.set.frames[i], map.set.surveys);
      const FloorCamera found = CameraOf(other.set.frames[i], other.set.surveys);
      const Eigen::Vector2d view = given.floor.roi.Center();
      const Eigen::Vector2d same = found.FloorFromRawPixel(given.RawPixelFromFloor(view));
      moved.views.push_back({ToComplex(*before * view), ToComplex(*after * same)});
      moved.poses.push_back({ToComplex(*before * view), ToComplex(*after * view)});
    }
  }
  return moved;
}

}  // namespace

CameraDoubt DoubtCameras(const CalibratedFrames& map, const SelfCalibrationOptions& options) {
  SelfCalibrationOptions automatic = options;
  automatic.automatic = true;
  const CalibratedFrames other = SelfCalibrate(map.set, map.placement, automatic);
  CameraDoubt doubt;
  if (!other.calibration.given_up.empty()) {
    return doubt;
  }
  const Moved moved = CollectMoved(map, other);
  if (moved.views.empty()) {
    return doubt;
  }
  for (std::size_t s = 0; s < map.set.surveys.size(); ++s) {
    const FloorCamera& given = map.set.surveys[s].survey.camera;
    doubt.camera_px = std::max(
        doubt.camera_px, LargestDisplacement(given, other.set.surveys[s].survey.camera) / given.floor.resolution_m);
  }
  const std::vector<double> bend = Misfits(moved.views);
  doubt.bend_rms_m = Rms(bend);
  doubt.bend_largest_m = *std::max_element(bend.begin(), bend.end());
  doubt.pose_rms_m = Rms(Misfits(moved.poses));
  return doubt;
}

}  // namespace floorloc
