// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/mosaic/mosaic_input.h"

namespace floorloc {

struct MosaicOptions {
  int tile_px = 256;
  int jpeg_quality = 90;
  double resolution_m = 0.0;  ///< of the finest level
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Layout of the pyramid that covers the extent; its coarsest level is at most two tiles wide.
MosaicLayout MakeMosaicLayout(const RectM& extent, const MosaicOptions& options);

/// Composes the mosaic block by block, depth first, blending at every point the few frames that show it best. Tiles
/// without floor are left out. `sink` receives the finished tiles from one thread in a fixed order; the tiles are the
/// same for any number of threads.
///
/// Time is linear in the floor's area and the number of frames. Memory: 256 MiB of images, one block of 4 x 4 tiles (20
/// bytes per pixel; 21 MB with tiles of 256 px), one tile per level of the pyramid, and about 1.5 kB per frame.
void ComposeMosaic(const MosaicInput& input, const MosaicLayout& layout, const MosaicOptions& options,
                   const std::function<void(const std::vector<MosaicTile>&)>& sink);

}  // namespace floorloc
