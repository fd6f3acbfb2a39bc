// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "mapbuilder/simulation/quilting.h"

namespace floorloc {

/// Pitch of the tiles of every tiled floor, along x and y.
inline constexpr double kTilePitchM = 0.3;

/// How the tiles of a floor differ. All have the same print and the same joints.
struct TileVariation {
  double max_offset_m = 0.0;    ///< of a tile from its place, in any direction
  double max_turn_rad = 0.0;    ///< of a tile in its place, either way
  bool quarter_turns = false;   ///< prints are turned by 0, 90, 180 or 270 degrees
  double singular_share = 0.0;  ///< share of the tiles, at least one, that have a crack, a chip or a stain
};

/// Names of floors of square tiles: "tiles" differ by a slight tone, wear of the glaze and joints; "tiles-identical" in
/// nothing; "tiles-grout" by how they are laid, up to 1.5 mm and 0.5 degrees off; "tiles-turned" by quarter turns of
/// the print; "tiles-singular-1" and "tiles-singular-5" in nothing but the cracks, chips and stains of 1 and 5 % of
/// them.
std::vector<std::string> TileFloorNames();

/// Paints one of them (CV_8UC3). Throws std::invalid_argument for any other name.
cv::Mat PaintTileFloor(const std::string& name, const PixelGrid& grid, std::uint64_t seed);

/// Paints tiles that differ in nothing but what the variation says; those cut by the right and lower edge included. Two
/// of them that do not differ are equal pixel by pixel where the pitch is a whole number of pixels.
cv::Mat PaintTiles(const TileVariation& variation, const PixelGrid& grid, std::uint64_t seed);

}  // namespace floorloc
