// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/mosaic_level.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

// JPEG makes black pixels slightly non-zero, in particular next to floor.
constexpr int kMinFloorGray = 6;
constexpr int kJpegNoisePx = 3;

}  // namespace

RectM MosaicLevel::Extent() const {
  const double side_m = layout.TileSide(zoom);
  return {min_x * side_m, (max_x + 1) * side_m, min_y * side_m, (max_y + 1) * side_m};
}

MosaicLevel ReadMosaicLevel(const MapDatabase& map, double resolution_m) {
  MosaicLevel level;
  level.layout = map.ReadMosaicLayout();
  const double wanted_m = resolution_m > 0.0 ? resolution_m : level.layout.resolution_m;
  const double halvings = std::log2(wanted_m / level.layout.resolution_m);
  level.zoom =
      std::clamp(level.layout.max_zoom - static_cast<int>(std::floor(halvings + 1e-9)), 0, level.layout.max_zoom);
  level.tiles = map.ListMosaicTiles(level.zoom);
  if (level.tiles.empty()) {
    throw MapError("the map has no mosaic; build it again");
  }
  const auto [west, east] = std::minmax_element(level.tiles.begin(), level.tiles.end(),
                                                [](const TileId& a, const TileId& b) { return a.x < b.x; });
  const auto [south, north] = std::minmax_element(level.tiles.begin(), level.tiles.end(),
                                                  [](const TileId& a, const TileId& b) { return a.y < b.y; });
  level.min_x = west->x;
  level.max_x = east->x;
  level.min_y = south->y;
  level.max_y = north->y;
  return level;
}

cv::Mat DecodeMosaicTile(const std::vector<std::uint8_t>& jpeg, int tile_px) {
  try {
    return DecodeColor(jpeg, tile_px, tile_px, "mosaic tile");
  } catch (const InputError&) {
    throw MapError("a mosaic tile is damaged; restore the map from a copy or build it again", MapError::Kind::kDamaged);
  }
}

cv::Mat SurveyedPixels(const cv::Mat& bgr) {
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  cv::Mat valid = gray >= kMinFloorGray;
  const cv::Mat kernel = cv::Mat::ones(kJpegNoisePx, kJpegNoisePx, CV_8U);
  cv::morphologyEx(valid, valid, cv::MORPH_CLOSE, kernel);  // fills dark specks, which are floor
  cv::morphologyEx(valid, valid, cv::MORPH_OPEN, kernel);   // removes JPEG noise in black areas
  return valid;
}

cv::Mat DecodeMosaicTile(const MapDatabase& map, const MosaicLevel& level, const TileId& tile) {
  const auto jpeg = map.ReadMosaicTile(tile);
  return DecodeMosaicTile(jpeg.value_or(std::vector<std::uint8_t>()), level.layout.tile_px);
}

}  // namespace floorloc
