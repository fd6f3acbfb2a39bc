// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/surface/texture/floor_blocks.h"

namespace floorloc {

/// What the blocks of one survey's floor look like.
struct FloorTextureModel {
  int blocks = 0;  ///< of which it was made
  BlockTexture mean = BlockTexture::Zero();
  BlockTextureCovariance covariance = BlockTextureCovariance::Identity();
};

struct FloorModelOptions {
  int min_blocks = 100;  ///< fewer do not show how a floor varies
  /// Share of the blocks that make the model: the least typical ones show a mark, a joint or dirt, and would widen it
  /// until it holds any floor.
  double kept_share = 0.85;
  int passes = 4;  ///< of choosing those blocks and fitting them

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Mean and covariance of the blocks of a floor, by concentration steps (Rousseeuw & Van Driessen 1999). Empty: too few
/// of them, or they are all alike.
std::optional<FloorTextureModel> LearnFloorTexture(std::vector<BlockTexture> blocks,
                                                   const FloorModelOptions& options = {});

}  // namespace floorloc
