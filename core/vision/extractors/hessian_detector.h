// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Blobs of one scale: local maxima of the determinant of the Hessian (Lindeberg 1998), to a fraction of a pixel.
/// smooth: CV_32FC1, Gaussian-smoothed to the scale of the blobs. Keypoints are at least border_px - 0.5 from the edge;
/// pt has (0, 0) in the centre of the top-left pixel, response is the determinant; other fields are as cv::KeyPoint
/// leaves them. Only maxima above min_response are returned.
std::vector<cv::KeyPoint> DetectHessian(const cv::Mat& smooth, int border_px, float min_response);

}  // namespace floorloc
