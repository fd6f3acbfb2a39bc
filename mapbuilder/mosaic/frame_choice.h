// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mapbuilder/mosaic/frame_view.h"
#include "mapbuilder/mosaic/mosaic_grid.h"

namespace floorloc {

/// The frames that show the floor best at a node of the mosaic; their shares add up to 1.
struct NodeChoice {
  static constexpr int kFrames = 3;  ///< more only blur the mosaic by what their poses are off

  struct Chosen {
    int candidate = -1;             ///< -1: none
    float high_band_weight = 0.0F;  ///< of the high band, changes over short distances
    float low_band_weight = 0.0F;   ///< of the low band, changes over long distances
  };
  std::array<Chosen, kFrames> chosen;
  float depth_px = 0.0F;  ///< of the deepest frame's view

  bool empty() const { return chosen.front().candidate < 0; }
  /// Empty share for a frame that was not chosen.
  Chosen Of(int candidate) const;
};

/// Row-major, grid.nodes() a side.
using NodeChoices = std::vector<NodeChoice>;

/// Chooses at every node among the candidates, by how deep inside their view it lies. All shares are continuous over
/// the floor, and no seam is hard.
NodeChoices ChooseFrames(const MosaicGrid& grid, const std::vector<FrameView>& candidates);

}  // namespace floorloc
