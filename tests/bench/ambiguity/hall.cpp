// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/hall.h"

#include <algorithm>
#include <limits>

#include "mapbuilder/simulation/tile_floor.h"

namespace floorloc {
namespace {

constexpr int kMostFineTiles = 33;
constexpr double kCoarseM = 0.0006;  // a tile is a whole number of pixels

RectM ExtentOfViews(const std::vector<Pose2>& truth, const RectM& view) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  RectM extent{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Pose2& pose : truth) {
    for (const double x : {view.x_min, view.x_max}) {
      for (const double y : {view.y_min, view.y_max}) {
        const Eigen::Vector2d corner = pose * Eigen::Vector2d(x, y);
        extent = {std::min(extent.x_min, corner.x()), std::max(extent.x_max, corner.x()),
                  std::min(extent.y_min, corner.y()), std::max(extent.y_max, corner.y())};
      }
    }
  }
  return extent;
}

}  // namespace

double Hall::SideM() const { return tiles * kTilePitchM; }

FloorFiles Hall::Files(const std::filesystem::path& state) const {
  return {state, floor.name + "-" + std::to_string(tiles), floor.texture.resolution_m};
}

Hall MakeHall(const std::string& texture, int tiles) {
  Hall hall;
  hall.tiles = tiles;
  hall.floor.name = texture;
  hall.floor.texture.source = texture;
  hall.floor.texture.width_m = hall.floor.texture.height_m = hall.floor.mapped_width_m = hall.SideM();
  hall.floor.repeat_m = kTilePitchM;
  if (tiles > kMostFineTiles) {
    hall.floor.texture.resolution_m = kCoarseM;
  }
  return hall;
}

std::vector<ConditionCase> HallConditions() {
  std::vector<ConditionCase> conditions = ConditionCases();
  std::erase_if(conditions, [](const ConditionCase& c) { return c.name != "mild" && c.name != "hard"; });
  return conditions;
}

bool FitsElsewhere(const std::vector<Pose2>& truth, const RectM& view, const Hall& hall) {
  const RectM seen = ExtentOfViews(truth, view);
  return seen.x_min >= kTilePitchM || seen.x_max <= hall.SideM() - kTilePitchM || seen.y_min >= kTilePitchM ||
         seen.y_max <= hall.SideM() - kTilePitchM;
}

}  // namespace floorloc
