// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/floor_recognizer.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

double Median(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

// Standard deviation, robustly.
double Spread(std::vector<double> values) {
  constexpr double kOfGaussian = 1.4826;
  const double median = Median(&values);
  for (double& value : values) {
    value = std::abs(value - median);
  }
  return kOfGaussian * Median(&values);
}

}  // namespace

void FloorRecognitionOptions::Check() const {
  RequireOption(refused_share >= 0.0 && refused_share <= 1.0, "refused_share must be 0 to 1");
  RequireOption(named_share >= refused_share && named_share <= 1.0, "named_share must be refused_share to 1");
  RequireOption(min_blocks >= 1, "min_blocks must be at least 1");
  RequireOption(max_distance > 0.0, "max_distance must be positive");
  RequireOption((tolerance.array() > 0.0).all(), "tolerance must be positive");
  RequireOption(!blurs_px.empty() && !noise_shares.empty(), "blurs_px and noise_shares must not be empty");
  RequireOption(max_brightness_spread > 0.0 && max_contrast_spread > 0.0, "the spreads must be positive");
  RequireOption(blank_share > 0.0 && blank_share <= 1.0, "blank_share must be above 0 and at most 1");
  RequireOption(named_blank_share > 0.0 && named_blank_share <= 1.0, "named_blank_share must be above 0 and at most 1");
}

FloorRecognizer::FloorRecognizer(const std::vector<FloorTextureModel>& floors, const FloorRecognitionOptions& options)
    : options_(options) {
  options.Check();
  for (const FloorTextureModel& floor : floors) {
    BlockTextureCovariance covariance = floor.covariance;
    covariance.diagonal() += options.tolerance.cwiseAbs2();
    const Eigen::LLT<BlockTextureCovariance> factor(covariance);
    SeenFloor seen;
    seen.whitening = factor.matrixL().solve(BlockTextureCovariance::Identity());
    for (const double blur_px : options.blurs_px) {
      for (const double noise_share : options.noise_shares) {
        seen.means.push_back(seen.whitening * SeenUnder(floor.mean, {blur_px, noise_share}));
      }
    }
    floors_.push_back(std::move(seen));
  }
}

bool FloorRecognizer::IsKnown(const BlockTexture& texture) const {
  return std::any_of(floors_.begin(), floors_.end(), [&](const SeenFloor& floor) {
    const BlockTexture whitened = floor.whitening * texture;
    return std::any_of(floor.means.begin(), floor.means.end(), [&](const BlockTexture& mean) {
      return (whitened - mean).squaredNorm() < options_.max_distance;
    });
  });
}

StrangeView FloorRecognizer::Name(const std::vector<FloorBlock>& blocks, double blank_share) const {
  std::vector<double> brightness;
  std::vector<double> contrast;
  for (const FloorBlock& block : blocks) {
    brightness.push_back(std::log(std::max(1.0, block.mean)));
    contrast.push_back(block.texture(0));
  }
  const bool mixed = Spread(std::move(brightness)) > options_.max_brightness_spread ||
                     Spread(std::move(contrast)) > options_.max_contrast_spread;
  return mixed || blank_share >= options_.blank_share ? StrangeView::kNoFloor : StrangeView::kOtherFloor;
}

FloorVerdict FloorRecognizer::Look(const GroundImage& image) const {
  FloorVerdict view;
  if (floors_.empty() || image.gray.empty()) {
    return view;
  }
  std::vector<FloorBlock> blocks = MeasureFloorBlocks(image);
  std::erase_if(blocks, [](const FloorBlock& block) { return block.clipped; });
  view.blocks = static_cast<int>(blocks.size());
  if (view.blocks < options_.min_blocks) {
    return view;
  }
  const double enough = options_.named_share * view.blocks;
  double known = 0.0;
  for (auto block = blocks.begin(); block != blocks.end() && known < enough; ++block) {
    known += IsKnown(block->texture) ? 1.0 : 0.0;
  }
  view.known_share = known / view.blocks;
  view.hopeless = view.known_share < options_.refused_share;
  const auto blank = std::count_if(blocks.begin(), blocks.end(), [](const FloorBlock& block) { return block.blank; });
  const double blank_share = static_cast<double>(blank) / view.blocks;
  if (view.known_share < options_.named_share || blank_share >= options_.named_blank_share) {
    view.strange = Name(blocks, blank_share);
  }
  return view;
}

}  // namespace floorloc
