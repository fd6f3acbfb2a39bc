// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/map/map_database.h"

namespace floorloc {

/// One level of a map's mosaic: its tiles and their bounding rectangle of whole tiles.
struct MosaicLevel {
  MosaicLayout layout;
  int zoom = 0;
  std::vector<TileId> tiles;
  int min_x = 0, max_x = 0;  ///< of the tiles, inclusive
  int min_y = 0, max_y = 0;

  int columns() const { return max_x - min_x + 1; }
  int rows() const { return max_y - min_y + 1; }
  double resolution_m() const { return layout.TileSide(zoom) / layout.tile_px; }
  /// Outer edges, map frame.
  RectM Extent() const;
  /// Position of a tile in an image of the whole level; row 0 is at y_max.
  cv::Point Corner(const TileId& tile) const {
    return {(tile.x - min_x) * layout.tile_px, (max_y - tile.y) * layout.tile_px};
  }
};

/// Coarsest level that is at least as fine as resolution_m (0: the finest). Throws MapError when the map has no mosaic.
MosaicLevel ReadMosaicLevel(const MapDatabase& map, double resolution_m);

/// CV_8UC3, tile_px x tile_px. Throws MapError when the bytes are no such image.
cv::Mat DecodeMosaicTile(const std::vector<std::uint8_t>& jpeg, int tile_px);

/// 255 where a tile, or an image of tiles, shows surveyed floor, 0 where it is black but for JPEG noise. CV_8UC1.
cv::Mat SurveyedPixels(const cv::Mat& bgr);

/// CV_8UC3. Throws MapError when it is damaged.
cv::Mat DecodeMosaicTile(const MapDatabase& map, const MosaicLevel& level, const TileId& tile);

}  // namespace floorloc
