// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "tests/bench/scenes/bench_floor.h"
#include "tests/bench/scenes/cases.h"

namespace floorloc {

/// A square hall whose floor is tiled and surveyed from wall to wall.
struct Hall {
  FloorCase floor;
  int tiles = 0;  ///< along each side

  double SideM() const;
  /// Where its image, survey and map are kept.
  FloorFiles Files(const std::filesystem::path& state) const;
};

/// texture: one of TileFloorNames(). Floors of more than 33 tiles are painted at 0.6 instead of 0.5 mm per pixel, so
/// that their images stay below 400 million pixels.
Hall MakeHall(const std::string& texture, int tiles);

/// "mild" and "hard" of ConditionCases().
std::vector<ConditionCase> HallConditions();

/// True when the same motion could have been made a tile beside, along x or y or both ways, with all views on the
/// hall's floor: then nothing that was seen on a floor of identical tiles tells the two apart. truth: poses of the base
/// in the hall, whose lower left corner is the origin; view: of the camera, base frame.
bool FitsElsewhere(const std::vector<Pose2>& truth, const RectM& view, const Hall& hall);

}  // namespace floorloc
