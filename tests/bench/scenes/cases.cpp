// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/cases.h"

#include "tests/bench/scenes/bench_floor.h"

namespace floorloc {
namespace {

constexpr double kUnmappedWidthM = 1.2;
constexpr double kMildWear = 0.03;
constexpr double kHardWear = 0.2;
constexpr double kHardOverlay = 0.05;

FloorCase MakeFloor(const std::string& name, const std::string& source, double width_m, double height_m) {
  FloorCase floor;
  floor.name = name;
  floor.texture.source = source;
  floor.texture.width_m = width_m + kUnmappedWidthM;
  floor.texture.height_m = height_m;
  floor.mapped_width_m = width_m;
  return floor;
}

// A quilted texture contains copies of its photograph.
FloorCase MakeQuilt(const std::string& name, const std::string& photograph, double width_m, double height_m) {
  FloorCase floor = MakeFloor(name, photograph, width_m, height_m);
  floor.copies_itself = true;
  return floor;
}

FloorCase MakeTiles(const std::string& name, std::uint64_t seed, double width_m) {
  FloorCase floor = MakeFloor(name, "tiles", width_m, 1.8);
  floor.texture.seed = seed;
  floor.repeat_m = 0.3;
  return floor;
}

}  // namespace

std::vector<FloorCase> FloorCases(const std::string& photograph) {
  return {MakeFloor("concrete", "concrete", 3.2, 2.2),
          MakeFloor("carpet", "carpet", 2.6, 1.8),
          MakeFloor("wood", "wood", 2.6, 1.8),
          MakeQuilt("photo", photograph, 2.6, 1.8),
          MakeTiles("tiles", 1, 2.6),
          MakeTiles("more-tiles", 2, 3.2)};
}

std::vector<ConditionCase> ConditionCases() {
  const ConditionLevels clean = ConditionLevels::FromName("clean");
  const ConditionLevels mild = ConditionLevels::FromName("mild");
  const ConditionLevels hard = ConditionLevels::FromName("hard");
  ConditionLevels blur = mild;
  blur.blur_px = hard.blur_px;
  blur.defocus_px = hard.defocus_px;
  ConditionLevels light = mild;
  light.gain = hard.gain;
  light.bias = hard.bias;
  light.vignetting = hard.vignetting;
  light.light_gradient = hard.light_gradient;
  light.lamps = hard.lamps;
  light.shadow = hard.shadow;
  ConditionLevels vibration = mild;
  vibration.vibration_pitch_rad = hard.vibration_pitch_rad;
  vibration.vibration_roll_rad = hard.vibration_roll_rad;
  vibration.vibration_height_m = hard.vibration_height_m;
  return {{"clean", clean, 0.0},
          {"mild", mild, kMildWear},
          {"blur", blur, kMildWear},
          {"light", light, kMildWear},
          {"vibration", vibration, kMildWear},
          {"changed", mild, kHardWear},
          {"hard", hard, kHardWear, OverlayOfBenchCamera({.kind = OverlayKind::kPart, .share = kHardOverlay})}};
}

std::shared_ptr<const CameraOverlay> OverlayOfBenchCamera(const OverlayOptions& options) {
  const CameraModel camera = BenchCamera().camera;
  return std::make_shared<const CameraOverlay>(options, cv::Size(camera.width_px, camera.height_px));
}

}  // namespace floorloc
