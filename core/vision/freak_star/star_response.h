// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"

namespace floorloc {

/// Sums over triangles of an image, which give the sum over a tilted square in four reads.
class TriangleSums {
 public:
  /// gray: CV_8UC1, not empty.
  explicit TriangleSums(const cv::Mat& gray);

  /// Row y, -1 to height - 1: entry x is the sum over the triangle that opens upwards from the pixel (x, y) at 45
  /// degrees to both sides.
  const std::uint32_t* odd(int y) const { return Row(odd_, y) + 1; }
  /// The same from the two pixels (x, y) and (x + 1, y); x from -1.
  const std::uint32_t* even(int y) const { return Row(even_, y) + 1; }

 private:
  static const std::uint32_t* Row(const cv::Mat& sums, int y) {
    return reinterpret_cast<const std::uint32_t*>(sums.ptr<int>(y + 2));
  }

  cv::Mat odd_;   // CV_32SC1; two rows of zeros and one column on each side more than the image
  cv::Mat even_;  // likewise
};

/// A star: the sum over an upright square with a side of 2 square + 1 px plus that over a square tilted by 45 degrees,
/// 2 tip + 1 px from tip to tip; their overlap counts twice.
struct StarShape {
  int square = 0;
  int tip = 0;

  float area() const { return static_cast<float>((2 * square + 1) * (2 * square + 1) + 2 * tip * (tip + 1) + 1); }
};

/// One scale: the mean between inner and outer star minus the mean of the inner star.
struct StarScale {
  StarShape inner;
  StarShape outer;

  int size_px() const { return 2 * outer.tip + 1; }
};

/// Scales from 9 px tip to tip up to the given size, each about 1.4 times the previous one.
std::vector<StarScale> StarScales(int max_size_px);

/// Positive on dark blobs, grey levels; CV_32F, 0 where the outer star does not fit.
cv::Mat StarResponse(const IntegralImage& squares, const TriangleSums& triangles, const StarScale& scale);

}  // namespace floorloc
