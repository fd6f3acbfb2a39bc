// SPDX-License-Identifier: Apache-2.0
#include "core/map/camera_correction.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// Calibrations that went through a text file with fewer digits are still the same.
constexpr double kTolerance = 1e-6;

bool Near(double a, double b) { return std::abs(a - b) <= kTolerance * std::max({1.0, std::abs(a), std::abs(b)}); }

bool SameLens(const CameraModel& a, const CameraModel& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && a.distortion_model == b.distortion_model &&
         Near(a.fx, b.fx) && Near(a.fy, b.fy) && Near(a.cx, b.cx) && Near(a.cy, b.cy) &&
         std::equal(a.distortion.begin(), a.distortion.end(), b.distortion.begin(), b.distortion.end(), Near);
}

}  // namespace

double LargestDisplacement(const FloorCamera& before, const FloorCamera& after) {
  const RectM& roi = before.floor.roi;
  const Eigen::Vector2d middle = roi.Center();
  double largest_m = 0.0;
  for (const double x : {roi.x_min, middle.x(), roi.x_max}) {
    for (const double y : {roi.y_min, middle.y(), roi.y_max}) {
      const Eigen::Vector2d p(x, y);
      const double moved_m = (after.FloorFromRawPixel(before.RawPixelFromFloor(p)) - p).norm();
      largest_m = std::isfinite(moved_m) ? std::max(largest_m, moved_m) : largest_m;
    }
  }
  return largest_m;
}

// Homographies are equal up to a factor; they are compared by where they put floor points: the centre of the region at
// least must have a place, corners may lie beyond what the lens model describes.
bool SameCalibration(const FloorCamera& a, const FloorCamera& b) {
  return SameLens(a.camera, b.camera) && b.FloorFromRawPixel(a.RawPixelFromFloor(a.floor.roi.Center())).allFinite() &&
         LargestDisplacement(a, b) <= kTolerance;
}

std::optional<CameraCorrection> CorrectCamera(const MapInfo& info, const FloorCamera& camera) {
  for (std::size_t survey = info.given_cameras.size(); survey-- > 0;) {
    if (!SameCalibration(info.given_cameras[survey], camera)) {
      continue;
    }
    CameraCorrection correction{static_cast<int>(survey), info.cameras[survey], 0.0};
    correction.camera.camera.name = camera.camera.name;
    correction.camera.camera.readout = camera.camera.readout;
    correction.camera.floor.roi = camera.floor.roi;
    correction.camera.floor.resolution_m = camera.floor.resolution_m;
    correction.moved_px = LargestDisplacement(camera, correction.camera) / camera.floor.resolution_m;
    return correction;
  }
  return std::nullopt;
}

FloorCamera CorrectedOrGiven(const MapInfo& info, const FloorCamera& camera) {
  const std::optional<CameraCorrection> correction = CorrectCamera(info, camera);
  return correction ? correction->camera : camera;
}

}  // namespace floorloc
