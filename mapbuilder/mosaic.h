// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/exposure.h"
#include "mapbuilder/survey_frames.h"

namespace floorloc {

struct MosaicOptions {
  int tile_px = 256;
  int jpeg_quality = 90;
  double resolution_m = 0.0;  ///< of the finest level
  int threads = 0;
  ProgressOutput progress;
};

/// Everything the mosaic is made of.
struct MosaicInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const Exposure& exposure;
  RectM extent;  ///< of the surveyed floor, map frame
};

/// The pyramid that covers the extent, its coarsest level at most two tiles wide.
MosaicLayout MakeMosaicLayout(const RectM& extent, const MosaicOptions& options);

/// Composes the mosaic block by block, depth first, so that memory is bounded at any size: each frame weighs most in
/// its middle. Tiles without floor are left out. `sink` gets the finished tiles, from one thread, in a fixed order.
void ComposeMosaic(const MosaicInput& input, const MosaicLayout& layout, const MosaicOptions& options,
                   const std::function<void(const std::vector<MosaicTile>&)>& sink);

}  // namespace floorloc
