// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

/// Gaussian smoothing, mirrored at the edges (the edge pixel twice). image: CV_8UC1 or CV_32FC1; returns CV_32FC1,
/// the same on every processor. sigma_px 0: only converts.
cv::Mat SmoothGaussian(const cv::Mat& image, double sigma_px);

}  // namespace floorloc
