// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/simulation/floor_texture.h"
#include "mapbuilder/simulation/render_conditions.h"

namespace floorloc {

/// A floor of the benchmark: its left part is surveyed, the rest never; both are the same kind of floor.
struct FloorCase {
  std::string name;  ///< also of its files
  FloorTextureOptions texture;
  double mapped_width_m = 0.0;
  /// What was never surveyed shows the same images, pixel by pixel: no frame is taken there, for none could be
  /// distinguished.
  bool copies_itself = false;
  double repeat_m = 0.0;  ///< the floor nearly repeats itself after this distance; 0: it doesn't
};

/// photograph: of a floor, for the floors that are quilted from it.
std::vector<FloorCase> FloorCases(const std::string& photograph);

/// What can be wrong with a frame.
struct ConditionCase {
  std::string name;
  ConditionLevels levels;
  double wear = 0.0;  ///< share of the floor that has changed since the survey
};

/// clean, mild, hard; and what makes hard hard, one by one, on top of mild.
std::vector<ConditionCase> ConditionCases();

}  // namespace floorloc
