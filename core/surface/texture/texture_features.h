// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Mean, variance and energy (sum of the squared probabilities) of the grey levels, and the share of outliers beyond
/// three standard deviations: Otsu et al. (2013), section 4.2.
using TextureFeatures = Eigen::Vector4d;

/// gray: CV_8UC1, not empty.
TextureFeatures MeasureTexture(const cv::Mat& gray);

/// How an image is divided (section 3.1).
struct TextureGrid {
  int columns = 4;
  int rows = 3;
  int skipped_rows = 0;  ///< from above, where a camera sees far: 1 in the article; 0 for one that looks down

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

struct TextureBlock {
  cv::Rect area;  ///< pixels
  TextureFeatures features;
};

/// The blocks of an image, row by row. gray: CV_8UC1 with at least a pixel for each block.
std::vector<TextureBlock> MeasureTextureBlocks(const cv::Mat& gray, const TextureGrid& grid = {});

}  // namespace floorloc
