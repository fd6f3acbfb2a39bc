// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// A closed contour in an image.
struct ContourShape {
  cv::KeyPoint keypoint;  ///< centroid, direction of the major axis, diameter of the circle of equal area
  std::vector<float> hu;  ///< the seven Hu moments as sign * log10 of their magnitude, to be comparable
};

/// Thresholds the image adaptively, detects edges (Canny) and returns the external contours, without nested ones, those
/// that touch the image border, and specks. gray: CV_8UC1.
std::vector<ContourShape> FindContourShapes(const cv::Mat& gray);

}  // namespace floorloc
