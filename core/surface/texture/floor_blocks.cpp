// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/floor_blocks.h"

#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/surface/texture/block_pyramid.h"

namespace floorloc {
namespace {

// Keeps logarithms finite: far below the noise of any camera, grey levels squared.
constexpr double kMinContrast = 1e-3;
constexpr double kClippedShare = 0.02;
constexpr double kGaussianEnergy = 0.28209479177387814;  // 1 / (2 sqrt(pi))

double LogRatio(double numerator, double denominator) { return 0.5 * std::log(numerator / denominator); }

// The logarithms of the contrasts relative to the brightness, by level.
std::array<double, kPyramidLevels> LogContrasts(const BlockTexture& t) {
  return {t(1) + t(0), t(0), t(2) + t(0), t(3) + t(0)};
}

bool IsBlank(const BlockPyramid& block, const BlockTexture& texture) {
  constexpr double kDark = 12.0;  // as in the screening of survey images: only noise
  constexpr double kFlat = 0.25;  // contrast, grey levels squared: what rounding leaves
  // The contrast of white noise halves from level to level, by ln 2 = 0.69; rectifying smooths the finest ones.
  const bool like_noise = texture(1) > -0.2 && texture(2) < -0.5 && texture(3) < -0.9;
  return block.mean < kDark || block.contrast[1] < kFlat || like_noise;
}

FloorBlock Measure(const std::uint8_t* first, std::size_t stride) {
  const BlockPyramid block = MeasureBlockPyramid(first, stride);
  std::array<double, kPyramidLevels> contrast = block.contrast;
  for (double& level : contrast) {
    level += kMinContrast;
  }
  const double brightness = std::max(1.0, block.mean);
  // In steps of half a grey level, of which a flat block has one.
  const double energy = block.energy * 2.0 * std::max(std::sqrt(block.variance), 0.5 * kGaussianEnergy);
  FloorBlock found;
  found.mean = block.mean;
  found.texture << LogRatio(contrast[1], brightness * brightness), LogRatio(contrast[0], contrast[1]),
      LogRatio(contrast[2], contrast[1]), LogRatio(contrast[3], contrast[1]), std::log(energy);
  found.blank = IsBlank(block, found.texture);
  found.clipped = !found.blank && block.clipped > kClippedShare;
  return found;
}

}  // namespace

std::vector<FloorBlock> MeasureFloorBlocks(const GroundImage& image) {
  std::vector<FloorBlock> blocks;
  for (int v = 0; v + kFloorBlockPx <= image.gray.rows; v += kFloorBlockPx) {
    for (int u = 0; u + kFloorBlockPx <= image.gray.cols; u += kFloorBlockPx) {
      const cv::Rect block(u, v, kFloorBlockPx, kFloorBlockPx);
      if (cv::countNonZero(image.mask(block)) == block.area()) {
        blocks.push_back(Measure(image.gray.ptr<std::uint8_t>(v) + u, image.gray.step));
      }
    }
  }
  return blocks;
}

BlockTexture SeenUnder(const BlockTexture& texture, const ViewingCondition& condition) {
  constexpr double kBlurGain = 9.6;  // fitted
  std::array<double, kPyramidLevels> levels = LogContrasts(texture);
  double side_px = 1.0;
  for (double& level : levels) {
    side_px *= 2.0;
    const double blur = condition.blur_px / side_px;
    const double noise = condition.noise_share / side_px;
    const double squared = std::exp(2.0 * level) / (1.0 + kBlurGain * blur * blur);
    level = 0.5 * std::log(squared + 2.0 * noise * noise);
  }
  // Noise makes any distribution a Gaussian one. The contrast of the coarsest level stands for the floor's variance.
  const double noise = condition.noise_share * condition.noise_share / 4.0;
  const double floor = std::exp(2.0 * levels[3]);
  const double share = noise / (noise + floor);
  BlockTexture seen;
  seen << levels[1], levels[0] - levels[1], levels[2] - levels[1], levels[3] - levels[1],
      (1.0 - share) * texture(4) + share * std::log(kGaussianEnergy);
  return seen;
}

}  // namespace floorloc
