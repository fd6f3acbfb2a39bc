// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace floorloc {

/// A maximum over position and scale.
struct ResponsePeak {
  int i = 0;  ///< column of the sample
  int j = 0;  ///< row of the sample
  float value = 0.0F;
  cv::Vec3f offset;  ///< of the fitted parabola's peak from the sample: columns, rows, layers; each within (-1, 1)
};

/// Maxima of the middle one of three layers (CV_32F, one size; neighbours in scale) that are above the threshold and at
/// least margin + 1 samples from the edges, from top to bottom. Peaks that are too flat to localize are left out.
std::vector<ResponsePeak> FindPeaks(const std::array<cv::Mat, 3>& layers, int margin, float threshold);

}  // namespace floorloc
