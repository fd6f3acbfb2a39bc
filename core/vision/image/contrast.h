// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

struct ContrastOptions {
  int radius_px = 15;            ///< half side of the window of mean and standard deviation
  double smooth_sigma_px = 1.0;  ///< Gaussian smoothing first, in float: low-contrast floors span few grey levels

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Local contrast normalisation: 128 + 40 (I - mean) / standard deviation, so that one detector threshold suits all
/// floors and lighting. Pixels outside the mask become 128. gray, mask: CV_8UC1.
cv::Mat NormalizeContrast(const cv::Mat& gray, const cv::Mat& mask, const ContrastOptions& options);

}  // namespace floorloc
