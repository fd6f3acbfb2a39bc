// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/texture_features.h"

#include <cmath>
#include <cstdint>

#include "core/geometry/option_check.h"
#include "core/surface/texture/grey_histogram.h"

namespace floorloc {

TextureFeatures MeasureTexture(const cv::Mat& gray) {
  const GreyHistogram histogram = CountGreyLevels({gray.data, gray.step, gray.cols, gray.rows});
  const double pixels = static_cast<double>(gray.total());
  const LevelSums sums = SumLevels(histogram);
  const double mean = static_cast<double>(sums.levels) / pixels;
  const double variance = std::max(0.0, static_cast<double>(sums.squared_levels) / pixels - mean * mean);
  const double energy = static_cast<double>(sums.squared_counts) / (pixels * pixels);
  const double reach = 3.0 * std::sqrt(variance);
  double outliers = 0.0;
  for (int level = 0; level < mean - reach; ++level) {
    outliers += histogram[static_cast<std::size_t>(level)];
  }
  for (int level = kGreyLevels - 1; level > mean + reach; --level) {
    outliers += histogram[static_cast<std::size_t>(level)];
  }
  return {mean, variance, energy, outliers / pixels};
}

void TextureGrid::Check() const {
  RequireOption(columns >= 1 && columns <= 64, "columns must be 1 to 64");
  RequireOption(rows >= 1 && rows <= 64, "rows must be 1 to 64");
  RequireOption(skipped_rows >= 0 && skipped_rows < rows, "skipped_rows must be fewer than the rows");
}

std::vector<TextureBlock> MeasureTextureBlocks(const cv::Mat& gray, const TextureGrid& grid) {
  grid.Check();
  std::vector<TextureBlock> blocks;
  for (int row = grid.skipped_rows; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const cv::Point first(column * gray.cols / grid.columns, row * gray.rows / grid.rows);
      const cv::Point end((column + 1) * gray.cols / grid.columns, (row + 1) * gray.rows / grid.rows);
      const cv::Rect area(first, end);
      blocks.push_back({area, MeasureTexture(gray(area))});
    }
  }
  return blocks;
}

}  // namespace floorloc
