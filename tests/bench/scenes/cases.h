// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapbuilder/simulation/camera_overlay.h"
#include "mapbuilder/simulation/floor_texture.h"
#include "mapbuilder/simulation/render_conditions.h"

namespace floorloc {

/// A floor of the benchmark: its left part is surveyed, the rest of the same texture is not.
struct FloorCase {
  std::string name;  ///< also the prefix of its files
  FloorTextureOptions texture;
  double mapped_width_m = 0.0;
  /// The unsurveyed part repeats the surveyed part pixel by pixel: no frame is taken there, as it could not be
  /// distinguished from a mapped one.
  bool copies_itself = false;
  double repeat_m = 0.0;        ///< distance after which the floor nearly repeats itself; 0: it does not
  OverlayOptions overlay = {};  ///< of the survey's camera
};

/// photograph: image of a floor from which textures are quilted.
std::vector<FloorCase> FloorCases(const std::string& photograph);

/// Conditions under which a frame is taken.
struct ConditionCase {
  std::string name;
  ConditionLevels levels;
  double wear = 0.0;                                       ///< share of the floor that has changed since the survey
  std::shared_ptr<const CameraOverlay> overlay = nullptr;  ///< of the vehicle's camera
};

/// clean, mild, hard; and each degradation of hard alone, on top of mild. In hard frames a part of the robot covers 5 %
/// of the image, which the survey did not see.
std::vector<ConditionCase> ConditionCases();

/// What travels with BenchCamera().
std::shared_ptr<const CameraOverlay> OverlayOfBenchCamera(const OverlayOptions& options);

}  // namespace floorloc
