// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Something that happens to an image between survey and drive.
struct ImageChange {
  std::string name;
  std::function<cv::Matx23d(const cv::Size&)> motion;   ///< pixel after = motion * (pixel before, 1)
  std::function<cv::Mat(const cv::Mat& gray)> degrade;  ///< after the motion
};

/// Turns about the middle, a small change of scale, blur, noise, brightness and contrast.
std::vector<ImageChange> ImageChanges();

/// The changed image, of the same size; pixels that come from outside are grey.
cv::Mat Apply(const ImageChange& change, const cv::Mat& gray);

}  // namespace floorloc
