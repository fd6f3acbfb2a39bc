// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Features of an image: row i of descriptors belongs to keypoint i; CV_32F, or CV_8U (packed bits).
struct ImageFeatures {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// A detector with its descriptor, configured to find about as many keypoints as the other methods.
struct FeatureMethod {
  std::string name;
  std::function<ImageFeatures(const cv::Mat& gray)> extract;
};

/// Our SURF with dlib's octaves, layers and sampling, dlib's SURF, our SURF for floors, STAR with FREAK, and OpenCV's
/// SIFT and ORB. All keep the strongest max_keypoints, and then drop those whose descriptor would leave the image.
std::vector<FeatureMethod> ComparedMethods(int max_keypoints);

}  // namespace floorloc
