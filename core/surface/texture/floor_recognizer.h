// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <vector>

#include "core/surface/texture/floor_blocks.h"
#include "core/surface/texture/floor_model.h"

namespace floorloc {

/// When a view counts as one of a known floor. Numbers: docs/benchmarks/floor_texture.md.
struct FloorRecognitionOptions {
  /// A view of which a smaller share of the blocks is like a known floor is not searched for. Of 200 frames that were
  /// found with 20 % of the floor changed, blur, lamps and shadow the worst had 0.1. 0: none is refused.
  double refused_share = 0.03;
  /// The same for one that was searched for in vain: it is told what the view shows.
  double named_share = 0.08;
  int min_blocks = 12;          ///< a smaller view shows too little
  double max_distance = 11.07;  ///< squared Mahalanobis distance of a block that is alike: 95 % of chi-squared of 5
  /// Standard deviations that are added to the model's: gamma, black level and glare for the contrast; lens and
  /// compression for the others.
  BlockTexture tolerance = (BlockTexture() << 0.2, 0.06, 0.08, 0.15, 0.12).finished();
  std::vector<double> blurs_px = {0.0, 1.0, 2.0, 4.0, 7.0};  ///< ViewingCondition that are tried
  std::vector<double> noise_shares = {0.0, 0.04, 0.12};
  /// Spread (1.48 x median absolute deviation) of the logarithm of the blocks' brightness, and of their contrast, over
  /// a view: floors have up to 0.12 and 0.6, with lamps and shadow 0.3; photographs of things 0.15 to 0.9 and 0.2
  /// to 1.1.
  double max_brightness_spread = 0.25;
  double max_contrast_spread = 0.8;
  double blank_share = 0.5;        ///< of blocks that show nothing, in a strange view: no floor
  double named_blank_share = 0.9;  ///< the same in any view that was searched for in vain

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// What a view shows that is none of the known floors.
enum class StrangeView {
  kNoFloor,     ///< darkness, glare, a lens cap, or things of different kinds
  kOtherFloor,  ///< one texture all over, which no survey saw
};

struct FloorVerdict {
  int blocks = 0;
  double known_share = 1.0;            ///< of the blocks that are like a known floor; counted as far as it matters
  std::optional<StrangeView> strange;  ///< what a search in vain was for
  bool hopeless = false;               ///< no search would find it
};

/// Tells from its texture whether a view can be of one of some floors. Immutable, thread-safe.
class FloorRecognizer {
 public:
  /// Without models every floor counts as known.
  explicit FloorRecognizer(const std::vector<FloorTextureModel>& floors, const FloorRecognitionOptions& options = {});

  /// image: at the resolution of the surveys that the models are of.
  FloorVerdict Look(const GroundImage& image) const;

 private:
  struct SeenFloor {
    BlockTextureCovariance whitening;  // lower triangular
    std::vector<BlockTexture> means;   // whitened, one per condition
  };

  bool IsKnown(const BlockTexture& texture) const;
  StrangeView Name(const std::vector<FloorBlock>& blocks, double blank_share) const;

  FloorRecognitionOptions options_;
  std::vector<SeenFloor> floors_;
};

}  // namespace floorloc
