// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/camera_mounting.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "mapbuilder/calibration/floor_calibration.h"
#include "mapbuilder/calibration/floor_region.h"

namespace floorloc {
namespace {

std::string Place(const Eigen::Isometry3d& base_from_camera) {
  char text[96];
  std::snprintf(text, sizeof(text), "the camera %.3f m over the floor, looking %.1f degrees below the horizon",
                base_from_camera.translation().z(), PitchDownRad(base_from_camera) * 180.0 / std::numbers::pi);
  return text;
}

}  // namespace

void MountingOptions::Check() const {
  RequireOption(min_height_m > 0.0, "min_height_m must be positive");
  RequireOption(min_pitch_down_rad >= 0.0 && min_pitch_down_rad < 1.5, "min_pitch_down_rad must be 0 to 1.5");
}

double PitchDownRad(const Eigen::Isometry3d& base_from_camera) {
  return std::asin(std::clamp(-base_from_camera.linear()(2, 2), -1.0, 1.0));
}

FloorPlane FloorOfMounting(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera,
                           const MountingOptions& options) {
  options.Check();
  if (!(base_from_camera.translation().z() >= options.min_height_m) ||
      !(PitchDownRad(base_from_camera) >= options.min_pitch_down_rad)) {
    throw InputError("has " + Place(base_from_camera));
  }
  try {
    return ChooseFloorRegion(camera, BaseFromPixel(camera, base_from_camera), {});
  } catch (const InputError&) {  // it names options of other commands
    throw InputError("has " + Place(base_from_camera) + ", where it sees too little floor");
  }
}

}  // namespace floorloc
