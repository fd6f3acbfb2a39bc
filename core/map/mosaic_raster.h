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

/// A patch of the mosaic. Row 0 is the upper edge; y decreases with the row.
struct RasterPatch {
  cv::Mat gray;           ///< CV_8UC1, contrast-normalised to 1..255; 0 where no floor was surveyed
  double x_left_m = 0.0;  ///< map frame, centre of column 0
  double y_top_m = 0.0;   ///< map frame, centre of row 0
  double resolution_m = 0.0;
  int window_px = 0;      ///< ContrastOptions::radius_px in pixels of the patch
  bool has_gaps = false;  ///< some of it was not surveyed

  /// Column and row of a map point.
  Eigen::Vector2d PixelFromMap(const Eigen::Vector2d& p) const {
    return {(p.x() - x_left_m) / resolution_m, (y_top_m - p.y()) / resolution_m};
  }
};

/// The finest level of a map's mosaic as frames are aligned to it: tiles are decoded and contrast-normalised on demand
/// and kept in an LRU cache, and so are they blurred, as blurred frames show the floor. Thread-safe.
class MosaicRaster {
 public:
  /// Of Cut: beyond 6 pixels of blur too little is left to align.
  static constexpr int kMaxBlurLevel = 3;

  /// contrast: as for the frames that will be compared. memory_bytes: limit of the cache.
  MosaicRaster(MosaicTileSource source, const MosaicLayout& layout, const ContrastOptions& contrast,
               std::size_t memory_bytes);

  /// The patch that covers the rectangle (map frame). Tiles that can't be decoded count as not surveyed. blur_level: 0
  /// to kMaxBlurLevel, how often the mosaic is halved with Gaussian smoothing (Burt & Adelson 1983): its blur is then
  /// 0, 1, 2.2, 4.6 pixels (standard deviation), its resolution 1, 2, 4, 8 times as coarse.
  RasterPatch Cut(const RectM& rect, int blur_level = 0) const;

  double resolution_m() const { return layout_.resolution_m; }

 private:
  using Tile = std::shared_ptr<const cv::Mat>;  // empty image: no floor there
  struct Key {
    int x = 0;
    int y = 0;
    int blur_level = 0;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  struct Cached {
    Tile tile;
    std::list<Key>::iterator place;
  };

  void Fill(const Eigen::Vector2d& upper_left, int blur_level, cv::Mat* patch) const;
  Tile Get(const Key& key) const;
  cv::Mat Make(const Key& key) const;
  cv::Mat Load(int x, int y) const;
  cv::Mat ReadGray(const TileId& tile) const;
  std::size_t BytesOf(const Tile& tile) const;
  void MakeRoom() const;

  MosaicTileSource source_;
  MosaicLayout layout_;
  ContrastOptions contrast_;
  std::size_t max_bytes_;
  mutable std::mutex mutex_;
  mutable std::list<Key> recent_;  // most recently used first
  mutable std::unordered_map<Key, Cached, Hash> cache_;
  mutable std::size_t bytes_ = 0;
};

}  // namespace floorloc
