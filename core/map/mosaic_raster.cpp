// SPDX-License-Identifier: Apache-2.0
#include "core/map/mosaic_raster.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/map/map_error.h"

namespace floorloc {
namespace {

// Darker pixels are not floor: JPEG leaves artefacts beyond the floor's edge.
constexpr double kMinFloorGray = 6.0;
constexpr int kEdgePx = 5;

std::uint64_t KeyOf(int x, int y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) | static_cast<std::uint32_t>(y);
}

// Empty when the bytes are no image.
cv::Mat DecodeGray(const std::vector<std::uint8_t>& bytes) {
  try {
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {  // no bytes, or too many pixels by the header
    return {};
  }
}

cv::Mat FloorMask(const cv::Mat& gray) {
  cv::Mat mask = gray >= kMinFloorGray;
  if (cv::countNonZero(mask) < gray.rows * gray.cols) {
    cv::erode(mask, mask, cv::Mat::ones(kEdgePx, kEdgePx, CV_8U));
  }
  return mask;
}

}  // namespace

MosaicRaster::MosaicRaster(MosaicTileSource source, const MosaicLayout& layout, const ContrastOptions& contrast,
                           std::size_t memory_bytes)
    : source_(std::move(source)),
      layout_(layout),
      contrast_(contrast),
      max_tiles_(std::max<std::size_t>(
          64, memory_bytes / (static_cast<std::size_t>(layout.tile_px) * static_cast<std::size_t>(layout.tile_px)))) {}

cv::Mat MosaicRaster::Load(int x, int y) const {
  const cv::Mat gray = ReadGray({layout_.max_zoom, x, y});
  if (gray.rows != layout_.tile_px || gray.cols != layout_.tile_px) {
    return {};
  }
  const cv::Mat mask = FloorMask(gray);
  cv::Mat normalized = cv::max(NormalizeContrast(gray, mask, contrast_), 1);
  normalized.setTo(0, mask == 0);
  return normalized;
}

// A damaged tile counts as not surveyed; keypoints there are still used.
cv::Mat MosaicRaster::ReadGray(const TileId& tile) const {
  try {
    const auto jpeg = source_(tile);
    return jpeg ? DecodeGray(*jpeg) : cv::Mat();
  } catch (const MapError&) {
    return {};
  }
}

MosaicRaster::Tile MosaicRaster::Get(int x, int y) const {
  const std::uint64_t key = KeyOf(x, y);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = cache_.find(key); it != cache_.end()) {
      recent_.splice(recent_.begin(), recent_, it->second.place);
      return it->second.tile;
    }
  }
  // Decoded outside the lock: two threads may decode the same tile, but none waits.
  auto tile = std::make_shared<const cv::Mat>(Load(x, y));
  const std::scoped_lock lock(mutex_);
  if (!cache_.contains(key)) {
    recent_.push_front(key);
    cache_[key] = {tile, recent_.begin()};
    if (cache_.size() > max_tiles_) {
      cache_.erase(recent_.back());
      recent_.pop_back();
    }
  }
  return tile;
}

RasterPatch MosaicRaster::Cut(const RectM& rect) const {
  const double resolution = layout_.resolution_m;
  const double side = layout_.tile_px;
  // Tiles are counted in ints; beyond this there is no floor.
  const double farthest_m = 1e9 * side * resolution;
  if (!(std::abs(rect.x_min) < farthest_m && std::abs(rect.x_max) < farthest_m && std::abs(rect.y_min) < farthest_m &&
        std::abs(rect.y_max) < farthest_m)) {
    return {cv::Mat::zeros(1, 1, CV_8UC1), 0.0, 0.0, resolution};
  }
  // Pixel columns of the level are counted from the map frame's origin, rows upwards.
  const double first_column = std::floor(rect.x_min / resolution);
  const double last_column = std::floor(rect.x_max / resolution);
  const double first_row = std::floor(rect.y_min / resolution);
  const double last_row = std::floor(rect.y_max / resolution);
  RasterPatch patch{cv::Mat::zeros(static_cast<int>(last_row - first_row) + 1,
                                   static_cast<int>(last_column - first_column) + 1, CV_8UC1),
                    (first_column + 0.5) * resolution, (last_row + 0.5) * resolution, resolution};
  const cv::Rect whole(0, 0, patch.gray.cols, patch.gray.rows);
  const auto tile_of = [side](double pixel) { return static_cast<int>(std::floor(pixel / side)); };
  for (int y = tile_of(first_row); y <= tile_of(last_row); ++y) {
    for (int x = tile_of(first_column); x <= tile_of(last_column); ++x) {
      const Tile tile = Get(x, y);
      if (tile->empty()) {
        continue;
      }
      const cv::Rect place(static_cast<int>(x * side - first_column),
                           static_cast<int>(last_row + 1.0 - (y + 1.0) * side), layout_.tile_px, layout_.tile_px);
      const cv::Rect inside = place & whole;
      (*tile)(inside - place.tl()).copyTo(patch.gray(inside));
    }
  }
  return patch;
}

}  // namespace floorloc
