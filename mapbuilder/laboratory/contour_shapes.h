// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// A closed outline in an image.
struct ContourShape {
  cv::KeyPoint keypoint;  ///< centre of the area, direction of the long axis, diameter of the same area
  std::vector<float> hu;  ///< the seven Hu moments, as sign * log10 of their size so that they are comparable
};

/// Thresholds the image against its surroundings, traces edges (Canny) and keeps the outer outlines; nested ones and
/// those that touch the image's edge are dropped, and so are specks. gray: CV_8UC1.
std::vector<ContourShape> FindContourShapes(const cv::Mat& gray);

}  // namespace floorloc
