// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// A change of an image between survey and drive.
struct ImageChange {
  std::string name;
  std::function<cv::Matx23d(const cv::Size&)> motion;   ///< pixel after = motion * (pixel before, 1)
  std::function<cv::Mat(const cv::Mat& gray)> degrade;  ///< after the motion
};

/// Rotations about the centre, a small change of scale, blur, noise, brightness and contrast.
std::vector<ImageChange> ImageChanges();

/// The changed image, of the same size; pixels from outside the source are grey.
cv::Mat Apply(const ImageChange& change, const cv::Mat& gray);

}  // namespace floorloc
