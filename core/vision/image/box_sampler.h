// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"

namespace floorloc {

/// Points relative to a centre, in units of a scale.
struct SamplePattern {
  std::vector<float> u;
  std::vector<float> v;
};

/// side x side points around (0, 0), one unit apart, row by row.
SamplePattern SquareGrid(int side);

/// Pose of a pattern in an image.
struct SamplePatternPose {
  cv::Point2f center;  ///< px
  cv::Point2f u_axis;  ///< one unit along u, px; v is perpendicular, clockwise
  int box_px = 1;      ///< side of the upright square around each point over which the mean is taken
};

/// Means over squares at arbitrary subpixel positions of an image. Caches smoothed images: use one sampler per image
/// and thread.
class BoxSampler {
 public:
  explicit BoxSampler(const IntegralImage& integral) : integral_(integral) {}

  /// Writes one mean per point, grey levels. Squares that would leave the image are shifted into it.
  void Sample(const SamplePattern& pattern, const SamplePatternPose& pose, float* means);

 private:
  // Wider squares are rounded to whole pixels, which is accurate enough.
  static constexpr int kWidestSmoothed = 8;

  cv::Mat SmoothedRows(int box);

  const IntegralImage& integral_;
  cv::Mat block_;  // the smoothed images, stacked: separate large blocks would be returned to the system each time
  std::array<cv::Mat, kWidestSmoothed + 1> smoothed_;  // parts of the block by side of the square; empty until needed
};

}  // namespace floorloc
