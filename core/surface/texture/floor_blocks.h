// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/vision/image/ground_image.h"

namespace floorloc {

/// Texture of a block of floor by natural logarithms that neither gain nor light changes:
///   0   contrast of neighbouring means over 4 x 4 pixels, relative to the brightness
///   1   contrast over 2 x 2 pixels, relative to that over 4 x 4
///   2   contrast over 8 x 8 pixels, relative to that over 4 x 4
///   3   contrast over 16 x 16 pixels, relative to that over 4 x 4
///   4   energy of the distribution of grey levels times their standard deviation: -1.27 for a Gaussian, more where few
///       pixels hold the contrast
/// Otsu et al. (2013), section 4.2, take mean, variance, energy and outliers of the grey levels as they are, which
/// follow the exposure: a model of them refuses a floor in other light.
using BlockTexture = Eigen::Matrix<double, 5, 1>;
using BlockTextureCovariance = Eigen::Matrix<double, 5, 5>;

struct FloorBlock {
  BlockTexture texture;
  double mean = 0.0;     ///< grey level
  bool blank = false;    ///< nothing but noise, darkness or glare
  bool clipped = false;  ///< partly white: its texture is not that of what it shows
};

/// The texture of all blocks that show floor entirely, row by row.
std::vector<FloorBlock> MeasureFloorBlocks(const GroundImage& image);

/// How a vehicle's image may differ from a survey's.
struct ViewingCondition {
  double blur_px = 0.0;      ///< standard deviation of a Gaussian, rectified pixels
  double noise_share = 0.0;  ///< standard deviation of a pixel's noise over the brightness
};

/// The texture of the same floor under a condition. The blur's effect was fitted to blurred floors (carpet, concrete,
/// wood): to 0.1 for 1 to 3 px and for motion of 8 and 16 px.
BlockTexture SeenUnder(const BlockTexture& texture, const ViewingCondition& condition);

}  // namespace floorloc
