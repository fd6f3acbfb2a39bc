// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Drops keypoints where the mask (unless empty; CV_8UC1, of the image's size) is zero, sorts the rest by decreasing
/// response and keeps the first `count` (0: all).
void KeepStrongest(const cv::Mat& mask, int count, std::vector<cv::KeyPoint>* keypoints);

/// Drops keypoints whose reach (px, from the keypoint) leaves the image.
void DropNearEdge(const cv::Size& image_size, const std::function<float(const cv::KeyPoint&)>& reach_px,
                  std::vector<cv::KeyPoint>* keypoints);

}  // namespace floorloc
