// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace floorloc {

/// Summed-area table: the sum over a rectangle of an image in four reads.
class IntegralImage {
 public:
  /// Throws std::invalid_argument unless gray is CV_8UC1 or empty.
  explicit IntegralImage(const cv::Mat& gray);

  int width() const { return width_; }    ///< of the image, px
  int height() const { return height_; }  ///< of the image, px
  std::ptrdiff_t stride() const { return width_ + 1; }

  /// Row y, 0 to height(): entry x, 0 to width(), is the sum of the pixels above and left of the corner (x, y). Sums
  /// are modulo 2^32: exact for every rectangle of up to 16 million pixels, whatever the size of the image.
  const std::uint32_t* row(int y) const { return data() + y * stride(); }
  const std::uint32_t* data() const { return reinterpret_cast<const std::uint32_t*>(sums_.ptr<int>()); }

 private:
  int width_ = 0;
  int height_ = 0;
  cv::Mat sums_;  // CV_32SC1, continuous, one row and column more than the image
};

}  // namespace floorloc
