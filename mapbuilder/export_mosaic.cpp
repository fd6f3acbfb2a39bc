// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export_mosaic.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace floorloc {
namespace {

constexpr double kMaxSidePx = 30000.0;

// The coarsest level that is at least as fine as asked for.
int ZoomFor(const MosaicLayout& layout, double resolution_m) {
  const double halvings = std::log2(resolution_m / layout.resolution_m);
  return std::clamp(layout.max_zoom - static_cast<int>(std::floor(halvings + 1e-9)), 0, layout.max_zoom);
}

}  // namespace

MosaicPicture ExportMosaic(const MapDatabase& map, double resolution_m) {
  const MosaicLayout layout = map.ReadMosaicLayout();
  const double wanted_m = resolution_m > 0.0 ? resolution_m : layout.resolution_m;
  const int zoom = ZoomFor(layout, wanted_m);
  const std::vector<TileId> tiles = map.ListMosaicTiles(zoom);
  if (tiles.empty()) {
    throw MapError("the map has no mosaic; build it again");
  }
  const auto [min_x, max_x] =
      std::minmax_element(tiles.begin(), tiles.end(), [](const TileId& a, const TileId& b) { return a.x < b.x; });
  const auto [min_y, max_y] =
      std::minmax_element(tiles.begin(), tiles.end(), [](const TileId& a, const TileId& b) { return a.y < b.y; });
  const double side_m = layout.TileSide(zoom);
  const RectM grid{min_x->x * side_m, (max_x->x + 1) * side_m, min_y->y * side_m, (max_y->y + 1) * side_m};
  if (grid.width_m() / wanted_m > kMaxSidePx || grid.height_m() / wanted_m > kMaxSidePx) {
    throw MapError("the mosaic would have more than 30000 pixels a side; export it with a larger --resolution, e.g. " +
                   std::to_string(std::max(grid.width_m(), grid.height_m()) / kMaxSidePx));
  }
  const double zoom_resolution_m = side_m / layout.tile_px;
  cv::Mat whole =
      cv::Mat::zeros((max_y->y - min_y->y + 1) * layout.tile_px, (max_x->x - min_x->x + 1) * layout.tile_px, CV_8UC3);
  for (const TileId& tile : tiles) {
    const auto jpeg = map.ReadMosaicTile(tile);
    const cv::Mat picture = jpeg ? cv::imdecode(*jpeg, cv::IMREAD_COLOR) : cv::Mat();
    if (picture.cols != layout.tile_px || picture.rows != layout.tile_px) {
      throw MapError("a mosaic tile is damaged; restore the map from a copy or build it again");
    }
    picture.copyTo(whole(cv::Rect((tile.x - min_x->x) * layout.tile_px, (max_y->y - tile.y) * layout.tile_px,
                                  layout.tile_px, layout.tile_px)));
  }
  MosaicPicture result{whole, zoom_resolution_m, grid};
  if (std::abs(wanted_m / zoom_resolution_m - 1.0) > 1e-6) {
    const cv::Size size(static_cast<int>(std::lround(grid.width_m() / wanted_m)),
                        static_cast<int>(std::lround(grid.height_m() / wanted_m)));
    cv::resize(whole, result.bgr, size, 0, 0, wanted_m > zoom_resolution_m ? cv::INTER_AREA : cv::INTER_CUBIC);
    result.resolution_m = grid.width_m() / size.width;
  }
  return result;
}

}  // namespace floorloc
