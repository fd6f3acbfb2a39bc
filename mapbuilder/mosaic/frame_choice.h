// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mapbuilder/mosaic/frame_view.h"
#include "mapbuilder/mosaic/mosaic_grid.h"

namespace floorloc {

/// The frames chosen for a node of the mosaic; their weights add up to 1 in each band.
struct NodeChoice {
  static constexpr int kFrames = 3;  ///< more would blur the mosaic by their pose errors

  struct Chosen {
    int candidate = -1;             ///< -1: none
    float high_band_weight = 0.0F;  ///< high spatial frequencies
    float low_band_weight = 0.0F;   ///< low spatial frequencies
  };
  std::array<Chosen, kFrames> chosen;
  float depth_px = 0.0F;  ///< largest depth of the node inside any frame's view

  bool empty() const { return chosen.front().candidate < 0; }
  /// Zero weights for a frame that was not chosen.
  Chosen Of(int candidate) const;
};

/// Row-major, grid.nodes() per side.
using NodeChoices = std::vector<NodeChoice>;

/// Chooses frames at every node by the depth of the node inside their views. All weights are continuous over the floor,
/// so that there are no hard seams.
NodeChoices ChooseFrames(const MosaicGrid& grid, const std::vector<FrameView>& candidates);

}  // namespace floorloc
