// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_mosaic.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

constexpr double kMaxSidePx = 30000.0;

}  // namespace

MosaicImage ExportMosaic(const MapDatabase& map, double resolution_m) {
  const MosaicLevel level = ReadMosaicLevel(map, resolution_m);
  const double wanted_m = resolution_m > 0.0 ? resolution_m : level.layout.resolution_m;
  const RectM grid = level.Extent();
  // The level can have up to twice the requested pixels per side; more in a damaged map whose tiles are far apart.
  const double level_px = std::max(level.columns(), level.rows()) * static_cast<double>(level.layout.tile_px);
  if (grid.width_m() / wanted_m > kMaxSidePx || grid.height_m() / wanted_m > kMaxSidePx ||
      level_px > 2.0 * kMaxSidePx + level.layout.tile_px) {
    throw MapError("the mosaic would have more than 30000 pixels a side; export it with a larger --resolution, e.g. " +
                   std::to_string(std::max(grid.width_m(), grid.height_m()) / kMaxSidePx) + ", or with --geotiff");
  }
  const int tile_px = level.layout.tile_px;
  cv::Mat whole = cv::Mat::zeros(level.rows() * tile_px, level.columns() * tile_px, CV_8UC3);
  for (const TileId& tile : level.tiles) {
    DecodeMosaicTile(map, level, tile).copyTo(whole(cv::Rect(level.Corner(tile), cv::Size(tile_px, tile_px))));
  }
  MosaicImage result{whole, level.resolution_m(), grid};
  if (std::abs(wanted_m / level.resolution_m() - 1.0) > 1e-6) {
    // At least a pixel, however coarse it is wanted.
    const cv::Size size(std::max(1, static_cast<int>(std::lround(grid.width_m() / wanted_m))),
                        std::max(1, static_cast<int>(std::lround(grid.height_m() / wanted_m))));
    cv::resize(whole, result.bgr, size, 0, 0, wanted_m > level.resolution_m() ? cv::INTER_AREA : cv::INTER_CUBIC);
    result.resolution_m = grid.width_m() / size.width;
  }
  return result;
}

}  // namespace floorloc
