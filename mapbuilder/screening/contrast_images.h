// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

/// Half of a size, rounded down, at least 1.
cv::Size HalfSize(const cv::Size& size);
/// An image at half its size, each pixel the mean of those it covers.
cv::Mat ToHalfSize(const cv::Mat& image);
/// An image at another size, by its nearest pixels.
cv::Mat ToSize(const cv::Mat& image, const cv::Size& size);

/// Mean of the square window around every pixel.
cv::Mat WindowMean(const cv::Mat& image, int window_px);
/// Correlation of two images of zero mean (CV_32FC1) in the window around every pixel; the noise is a standard
/// deviation that is added to both.
cv::Mat WindowCorrelation(const cv::Mat& a, const cv::Mat& b, int window_px, double noise);

/// An image (CV_8UC1) at a smaller size, relative to its light, which neither exposure nor light nor vignetting
/// changes. The light is a median over a window of light_px at half of that size, so that the edge of a part of the
/// robot has no halo on the floor beside it. CV_32FC1.
cv::Mat StructureContrast(const cv::Mat& raw, const cv::Size& size, int light_px);

/// Where the windows that a map (CV_32FC2, pixels) takes from an image of its own size lie in it; CV_8UC1.
cv::Mat InView(const cv::Mat& map, int window_px);

}  // namespace floorloc
