// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/mosaic.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/mosaic/mosaic_block.h"

namespace floorloc {
namespace {

// Blocks of 2^kBlockLevels tiles a side are blended at once: small enough to bound memory, large enough that frames
// fill them.
constexpr int kBlockLevels = 2;

std::vector<std::uint8_t> EncodeJpeg(const cv::Mat& bgr, int quality) {
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
  return jpeg;
}

int FloorDivide(double value, double side) { return static_cast<int>(std::floor(value / side)); }

class Composer {
 public:
  Composer(const MosaicInput& input, const MosaicLayout& layout, const MosaicOptions& options,
           const std::function<void(const std::vector<MosaicTile>&)>& sink)
      : input_(input),
        layout_(layout),
        options_(options),
        sink_(sink),
        block_zoom_(std::max(0, layout.max_zoom - kBlockLevels)),
        blender_(input, layout.resolution_m, options.run.threads),
        progress_("mosaic", CountBlocks(), options.run.progress) {}

  void Run() {
    const double side = layout_.TileSide(0);
    for (int y = FloorDivide(input_.extent.y_min, side); y <= FloorDivide(input_.extent.y_max, side); ++y) {
      for (int x = FloorDivide(input_.extent.x_min, side); x <= FloorDivide(input_.extent.x_max, side); ++x) {
        Compose({0, x, y});
      }
    }
  }

 private:
  RectM SquareOf(const TileId& tile) const {
    const double side = layout_.TileSide(tile.z);
    return {tile.x * side, (tile.x + 1) * side, tile.y * side, (tile.y + 1) * side};
  }

  bool Overlaps(const RectM& square) const {
    return square.x_min <= input_.extent.x_max && square.x_max >= input_.extent.x_min &&
           square.y_min <= input_.extent.y_max && square.y_max >= input_.extent.y_min;
  }

  std::int64_t CountBlocks() const {
    const double side = layout_.TileSide(block_zoom_);
    const std::int64_t columns = FloorDivide(input_.extent.x_max, side) - FloorDivide(input_.extent.x_min, side) + 1;
    const std::int64_t rows = FloorDivide(input_.extent.y_max, side) - FloorDivide(input_.extent.y_min, side) + 1;
    return columns * rows;
  }

  // Depth-first, so that only one patch per level is in memory.
  MosaicPatch Compose(const TileId& tile) {
    if (!Overlaps(SquareOf(tile))) {
      return MosaicPatch::Empty(layout_.tile_px);
    }
    if (tile.z == block_zoom_) {
      return ComposeBlock(tile);
    }
    MosaicPatch patch = ShrinkFour(
        {Compose({tile.z + 1, 2 * tile.x, 2 * tile.y}), Compose({tile.z + 1, 2 * tile.x + 1, 2 * tile.y}),
         Compose({tile.z + 1, 2 * tile.x, 2 * tile.y + 1}), Compose({tile.z + 1, 2 * tile.x + 1, 2 * tile.y + 1})});
    if (!patch.empty()) {
      sink_({{tile, EncodeJpeg(patch.bgr, options_.jpeg_quality)}});
    }
    return patch;
  }

  // Blends the whole block at the finest level, then cuts it into tiles and downscales them.
  MosaicPatch ComposeBlock(const TileId& block) {
    progress_.Advance();
    const int tiles_per_side = 1 << (layout_.max_zoom - block_zoom_);
    const MosaicPatch whole = blender_.Blend(SquareOf(block), tiles_per_side * layout_.tile_px);
    if (whole.empty()) {
      return MosaicPatch::Empty(layout_.tile_px);
    }
    std::vector<MosaicPatch> level = CutTiles(whole, tiles_per_side);
    for (int z = layout_.max_zoom;; --z) {
      const int side = 1 << (z - block_zoom_);
      EmitTiles(level, {z, block.x * side, block.y * side}, side);
      if (z == block_zoom_) {
        return level.front();
      }
      level = ShrinkLevel(level, side);
    }
  }

  // Row-major from the lower left.
  std::vector<MosaicPatch> CutTiles(const MosaicPatch& whole, int tiles_per_side) const {
    std::vector<MosaicPatch> tiles;
    for (int y = 0; y < tiles_per_side; ++y) {
      for (int x = 0; x < tiles_per_side; ++x) {
        const cv::Rect rect(x * layout_.tile_px, (tiles_per_side - 1 - y) * layout_.tile_px, layout_.tile_px,
                            layout_.tile_px);
        tiles.push_back({whole.bgr(rect), whole.valid(rect)});
      }
    }
    return tiles;
  }

  std::vector<MosaicPatch> ShrinkLevel(const std::vector<MosaicPatch>& level, int side) const {
    const auto at = [&](int x, int y) {
      return level[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x)];
    };
    const int half = side / 2;
    std::vector<MosaicPatch> coarser(static_cast<std::size_t>(half * half));
    ParallelFor(half * half, options_.run.threads, [&](int i) {
      const int x = 2 * (i % half);
      const int y = 2 * (i / half);
      coarser[static_cast<std::size_t>(i)] = ShrinkFour({at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)});
    });
    return coarser;
  }

  void EmitTiles(const std::vector<MosaicPatch>& level, const TileId& lower_left, int side) {
    std::vector<MosaicTile> tiles(level.size());
    ParallelFor(static_cast<int>(level.size()), options_.run.threads, [&](int i) {
      const auto index = static_cast<std::size_t>(i);
      tiles[index].id = {lower_left.z, lower_left.x + i % side, lower_left.y + i / side};
      if (!level[index].empty()) {
        tiles[index].jpeg = EncodeJpeg(level[index].bgr, options_.jpeg_quality);
      }
    });
    std::erase_if(tiles, [](const MosaicTile& tile) { return tile.jpeg.empty(); });
    sink_(tiles);
  }

  const MosaicInput& input_;
  const MosaicLayout& layout_;
  const MosaicOptions& options_;
  const std::function<void(const std::vector<MosaicTile>&)>& sink_;
  int block_zoom_;
  BlockBlender blender_;
  ProgressBar progress_;
};

}  // namespace

void MosaicOptions::Check() const {
  RequireOption(tile_px >= 16 && tile_px <= 4096, "tile_px must be 16 to 4096");
  RequireOption(jpeg_quality >= 1 && jpeg_quality <= 100, "jpeg_quality must be 1 to 100");
  RequireOption(resolution_m >= 0.0 && resolution_m < 1.0,
                "resolution_m must be a positive number of metres below 1; 0: the surveys own");
  run.Check();
}

MosaicLayout MakeMosaicLayout(const RectM& extent, const MosaicOptions& options) {
  options.Check();
  MosaicLayout layout;
  layout.tile_px = options.tile_px;
  layout.resolution_m = options.resolution_m;
  const double widest = std::max(extent.width_m(), extent.height_m());
  const double tile_m = options.tile_px * options.resolution_m;
  layout.max_zoom = std::max(0, static_cast<int>(std::ceil(std::log2(std::max(widest / tile_m, 1.0)))));
  return layout;
}

void ComposeMosaic(const MosaicInput& input, const MosaicLayout& layout, const MosaicOptions& options,
                   const std::function<void(const std::vector<MosaicTile>&)>& sink) {
  Composer(input, layout, options, sink).Run();
}

}  // namespace floorloc
