// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/extend/extend_map.h"

#include <algorithm>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

// Fewer fixes could all be wrong.
constexpr std::size_t kMinFixes = 3;

}  // namespace

FrameSet AlignToMap(const BaseMap& base_map, const std::vector<PosePriorFactor>& fixes, FrameSet set) {
  const bool controlled = std::any_of(set.surveys.begin(), set.surveys.end(),
                                      [](const LoadedSurvey& loaded) { return !loaded.survey.control_points.empty(); });
  if (fixes.size() < kMinFixes && !controlled) {
    throw InputError(set.surveys.front().survey.folder,
                     "does not overlap the map: " + std::to_string(fixes.size()) + " of " +
                         std::to_string(set.frames.size()) + " frames show floor of " + base_map.file.string() +
                         "; let the survey begin and end on floor that the map has, or add control_points.csv");
  }
  for (const PosePriorFactor& fix : fixes) {
    set.frames[static_cast<std::size_t>(fix.frame)].prior = {fix.map_from_base, fix.covariance};
  }
  return set;
}

MosaicBackground ExtendedMosaic::Background() const {
  return [this](const RectM& square, int side_px) { return base_mosaic_.ReadPatch(square, side_px); };
}

bool ExtendedMosaic::IsCoveredByNew(const MosaicLayout& layout, const TileId& id) const {
  const double side_m = layout.TileSide(id.z);
  const double step_m = CoverageGrid::kCellM;
  for (double x = id.x * side_m - step_m; x <= (id.x + 1) * side_m + step_m; x += step_m) {
    for (double y = id.y * side_m - step_m; y <= (id.y + 1) * side_m + step_m; y += step_m) {
      if (new_.CountAt({x, y}) > 0) {
        return true;
      }
    }
  }
  return false;
}

void ExtendedMosaic::KeepBaseTiles(const MosaicLayout& layout, std::vector<MosaicTile>* tiles) const {
  for (MosaicTile& tile : *tiles) {
    if (tile.id.z == layout.max_zoom && !IsCoveredByNew(layout, tile.id)) {
      if (auto jpeg = base_map_.database.ReadMosaicTile({base_mosaic_.layout().max_zoom, tile.id.x, tile.id.y})) {
        tile.jpeg = std::move(*jpeg);
      }
    }
  }
}

RectM Union(const RectM& a, const RectM& b) {
  const auto empty = [](const RectM& r) { return r.width_m() <= 0.0 || r.height_m() <= 0.0; };
  if (empty(a) || empty(b)) {
    return empty(a) ? b : a;
  }
  return {std::min(a.x_min, b.x_min), std::max(a.x_max, b.x_max), std::min(a.y_min, b.y_min),
          std::max(a.y_max, b.y_max)};
}

}  // namespace floorloc
