// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/image/contrast.h"

namespace floorloc {

/// Returns the encoded image of a mosaic tile, empty where the map has none; throws MapError when it is damaged. Must
/// be thread-safe.
using MosaicTileSource = std::function<std::optional<std::vector<std::uint8_t>>(const TileId&)>;

/// A patch of the mosaic's finest level. Row 0 is the upper edge; y decreases with the row.
struct RasterPatch {
  cv::Mat gray;           ///< CV_8UC1, contrast-normalised to 1..255; 0 where no floor was surveyed
  double x_left_m = 0.0;  ///< map frame, centre of column 0
  double y_top_m = 0.0;   ///< map frame, centre of row 0
  double resolution_m = 0.0;

  /// Column and row of a map point.
  Eigen::Vector2d PixelFromMap(const Eigen::Vector2d& p) const {
    return {(p.x() - x_left_m) / resolution_m, (y_top_m - p.y()) / resolution_m};
  }
};

/// The finest level of a map's mosaic as frames are aligned to it: tiles are decoded and contrast-normalised on demand
/// and kept in an LRU cache. Thread-safe.
class MosaicRaster {
 public:
  /// contrast: as for the frames that will be compared. memory_bytes: limit of the cache.
  MosaicRaster(MosaicTileSource source, const MosaicLayout& layout, const ContrastOptions& contrast,
               std::size_t memory_bytes);

  /// The patch that covers the rectangle (map frame). Tiles that can't be decoded count as not surveyed.
  RasterPatch Cut(const RectM& rect) const;

  double resolution_m() const { return layout_.resolution_m; }

 private:
  using Tile = std::shared_ptr<const cv::Mat>;  // empty image: no floor there
  struct Cached {
    Tile tile;
    std::list<std::uint64_t>::iterator place;
  };

  Tile Get(int x, int y) const;
  cv::Mat Load(int x, int y) const;
  cv::Mat ReadGray(const TileId& tile) const;

  MosaicTileSource source_;
  MosaicLayout layout_;
  ContrastOptions contrast_;
  std::size_t max_tiles_;
  mutable std::mutex mutex_;
  mutable std::list<std::uint64_t> recent_;  // keys, most recently used first
  mutable std::unordered_map<std::uint64_t, Cached> cache_;
};

}  // namespace floorloc
