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

constexpr std::size_t kMinTiles = 64;  // in the cache

// Mean grey level of a normalised image, and the share (of 255) of a blurred pixel that may be unknown.
constexpr double kMiddleGray = 128.0;
constexpr double kMostUnknown = 64.0;

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

// Half as large and smoothed; pixel (u, v) lies where (2 u, 2 v) was. What is not surveyed stays so.
cv::Mat Halved(const cv::Mat& gray) {
  const cv::Mat none = gray == 0;
  cv::Mat halved;
  if (cv::countNonZero(none) == 0) {
    cv::pyrDown(gray, halved);
    return cv::max(halved, 1);
  }
  cv::Mat filled = gray.clone();
  filled.setTo(kMiddleGray, none);
  cv::pyrDown(filled, halved);
  halved = cv::max(halved, 1);
  cv::Mat touched;
  cv::pyrDown(none, touched);
  halved.setTo(0, touched > kMostUnknown);
  return halved;
}

}  // namespace

std::size_t MosaicRaster::Hash::operator()(const Key& key) const {
  const auto cell =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(key.x)) << 32) | static_cast<std::uint32_t>(key.y);
  return std::hash<std::uint64_t>()(cell * (kMaxBlurLevel + 1) + static_cast<std::uint64_t>(key.blur_level));
}

MosaicRaster::MosaicRaster(MosaicTileSource source, const MosaicLayout& layout, const ContrastOptions& contrast,
                           std::size_t memory_bytes)
    : source_(std::move(source)),
      layout_(layout),
      contrast_(contrast),
      max_bytes_(std::max(memory_bytes, kMinTiles * BytesOf(std::make_shared<const cv::Mat>()))) {}

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

cv::Mat MosaicRaster::Make(const Key& key) const {
  if (key.blur_level == 0) {
    return Load(key.x, key.y);
  }
  const Tile finer = Get({key.x, key.y, key.blur_level - 1});
  return finer->empty() ? cv::Mat() : Halved(*finer);
}

MosaicRaster::Tile MosaicRaster::Get(const Key& key) const {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = cache_.find(key); it != cache_.end()) {
      recent_.splice(recent_.begin(), recent_, it->second.place);
      return it->second.tile;
    }
  }
  // Decoded outside the lock: two threads may decode the same tile, but none waits.
  auto tile = std::make_shared<const cv::Mat>(Make(key));
  const std::scoped_lock lock(mutex_);
  if (!cache_.contains(key)) {
    recent_.push_front(key);
    cache_[key] = {tile, recent_.begin()};
    bytes_ += BytesOf(tile);
    MakeRoom();
  }
  return tile;
}

// An empty tile costs as much as another one, so that their number is bounded.
std::size_t MosaicRaster::BytesOf(const Tile& tile) const {
  const auto side = static_cast<std::size_t>(layout_.tile_px);
  return tile->empty() ? side * side : tile->total();
}

void MosaicRaster::MakeRoom() const {
  while (bytes_ > max_bytes_) {
    const auto oldest = cache_.find(recent_.back());
    bytes_ -= BytesOf(oldest->second.tile);
    cache_.erase(oldest);
    recent_.pop_back();
  }
}

RasterPatch MosaicRaster::Cut(const RectM& rect, int blur_level) const {
  const double resolution = std::ldexp(layout_.resolution_m, blur_level);
  // Tiles are counted in ints; beyond this there is no floor.
  const double farthest_m = 1e9 * layout_.tile_px * layout_.resolution_m;
  const bool halves = layout_.tile_px % (1 << blur_level) == 0;
  if (!(std::abs(rect.x_min) < farthest_m && std::abs(rect.x_max) < farthest_m && std::abs(rect.y_min) < farthest_m &&
        std::abs(rect.y_max) < farthest_m && halves)) {
    return {cv::Mat::zeros(1, 1, CV_8UC1), 0.0, 0.0, resolution, 0, true};
  }
  // Pixel columns of the level are counted from the map frame's origin, rows upwards.
  const double first_column = std::floor(rect.x_min / resolution);
  const double last_column = std::floor(rect.x_max / resolution);
  const double first_row = std::floor(rect.y_min / resolution);
  const double last_row = std::floor(rect.y_max / resolution);
  RasterPatch patch;
  patch.gray.create(static_cast<int>(last_row - first_row) + 1, static_cast<int>(last_column - first_column) + 1,
                    CV_8UC1);
  // Halving keeps the upper left pixel of each four in place.
  patch.x_left_m = first_column * resolution + 0.5 * layout_.resolution_m;
  patch.y_top_m = (last_row + 1.0) * resolution - 0.5 * layout_.resolution_m;
  patch.resolution_m = resolution;
  patch.window_px = contrast_.radius_px >> blur_level;
  Fill({first_column, last_row}, blur_level, &patch.gray);
  patch.has_gaps = cv::countNonZero(patch.gray) < patch.gray.rows * patch.gray.cols;
  return patch;
}

// upper_left: column and row of the level.
void MosaicRaster::Fill(const Eigen::Vector2d& upper_left, int blur_level, cv::Mat* patch) const {
  const cv::Rect whole(0, 0, patch->cols, patch->rows);
  const int side_px = layout_.tile_px >> blur_level;
  const double side = side_px;
  const auto tile_of = [side](double pixel) { return static_cast<int>(std::floor(pixel / side)); };
  for (int y = tile_of(upper_left.y() - patch->rows + 1.0); y <= tile_of(upper_left.y()); ++y) {
    for (int x = tile_of(upper_left.x()); x <= tile_of(upper_left.x() + patch->cols - 1.0); ++x) {
      const Tile tile = Get({x, y, blur_level});
      const cv::Rect place(static_cast<int>(x * side - upper_left.x()),
                           static_cast<int>(upper_left.y() + 1.0 - (y + 1.0) * side), side_px, side_px);
      const cv::Rect inside = place & whole;
      if (tile->empty()) {
        (*patch)(inside).setTo(0);
      } else {
        (*tile)(inside - place.tl()).copyTo((*patch)(inside));
      }
    }
  }
}

}  // namespace floorloc
