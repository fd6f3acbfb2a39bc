// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/simulate_arguments.h"

#include <numbers>

#include "core/io/camera_yaml.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

FloorCamera ChooseCamera(const SimulateArguments& arguments) {
  if (!arguments.camera_yaml.empty()) {
    FloorCamera camera;
    camera.camera = ParseCameraYaml(ReadTextFile(arguments.camera_yaml), arguments.camera_yaml);
    camera.floor = ParseFloorYaml(ReadTextFile(arguments.floor_yaml), arguments.floor_yaml);
    return camera;
  }
  const double height_m = arguments.camera_height_m;
  if (arguments.camera == "forward") {
    return height_m > 0.0 ? MakeForwardCamera(height_m) : MakeForwardCamera();
  }
  if (arguments.camera == "equidistant") {
    return height_m > 0.0 ? MakeEquidistantCamera(height_m) : MakeEquidistantCamera();
  }
  return height_m > 0.0 ? MakeDownwardCamera(height_m) : MakeDownwardCamera();
}

ConditionLevels ChooseConditions(const SimulateArguments& arguments) {
  ConditionLevels levels = ConditionLevels::FromName(arguments.condition);
  levels.blur_px = arguments.blur_px.value_or(levels.blur_px);
  levels.shadow = arguments.shadow.value_or(levels.shadow);
  levels.lamps = arguments.lamps.value_or(levels.lamps);
  levels.read_noise = arguments.noise.value_or(levels.read_noise);
  levels.readout_s = arguments.rolling_shutter_s.value_or(levels.readout_s);
  levels.height_share = arguments.height_variation.value_or(levels.height_share);
  levels.jpeg_quality = arguments.jpeg_quality.value_or(levels.jpeg_quality);
  levels.overlay = arguments.options.conditions.overlay;
  if (!arguments.overlay.empty()) {
    levels.overlay.kind = ParseOverlayKind(arguments.overlay);
    levels.overlay.share = arguments.overlay_share;
  }
  return levels;
}

CalibrationError ChooseCalibrationError(const SimulateArguments& a) {
  // Of the built-in cameras: files are taken as they are, and an equidistant lens has no tangential distortion.
  const bool usual = !a.exact_calibration && a.camera_yaml.empty();
  CalibrationError error = usual ? CalibrationError::ForCondition(a.condition) : CalibrationError();
  if (a.camera == "equidistant") {
    error.tangential_px = 0.0;
  }
  error.radial_px = a.radial_error.value_or(error.radial_px);
  error.tangential_px = a.tangential_error.value_or(error.tangential_px);
  error.principal_point_px = a.principal_point_error.value_or(error.principal_point_px);
  error.focal_share = a.focal_error.value_or(error.focal_share);
  error.roll_rad = a.roll_error_deg ? *a.roll_error_deg * kDegree : error.roll_rad;
  error.pitch_rad = a.pitch_error_deg ? *a.pitch_error_deg * kDegree : error.pitch_rad;
  error.height_m = a.height_error.value_or(error.height_m);
  return error;
}

}  // namespace floorloc
