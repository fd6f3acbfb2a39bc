// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"

namespace floorloc {

/// Points around a middle, in units of a scale.
struct SamplePattern {
  std::vector<float> u;
  std::vector<float> v;
};

/// side x side points around (0, 0), one unit apart, row by row.
SamplePattern SquareGrid(int side);

/// Where a pattern is put in an image.
struct SamplePatternPose {
  cv::Point2f center;  ///< px
  cv::Point2f u_axis;  ///< one unit along u, px; v runs at right angles, clockwise
  int box_px = 1;      ///< side of the upright square around each point whose mean is asked for
};

/// Means over squares at any points of an image, to a fraction of a pixel. Keeps smoothed images for the next grid:
/// one sampler per image and thread.
class BoxSampler {
 public:
  explicit BoxSampler(const IntegralImage& integral) : integral_(integral) {}

  /// Writes one mean per point, grey levels. Squares that would leave the image are moved into it.
  void Sample(const SamplePattern& pattern, const SamplePatternPose& pose, float* means);

 private:
  // Rounding to whole pixels is accurate enough for wider squares.
  static constexpr int kWidestSmoothed = 8;

  cv::Mat SmoothedRows(int box);

  const IntegralImage& integral_;
  cv::Mat block_;  // the smoothed images, one below the other: large blocks would else go back to the system each time
  std::array<cv::Mat, kWidestSmoothed + 1> smoothed_;  // parts of the block by side of the square; empty until needed
};

}  // namespace floorloc
