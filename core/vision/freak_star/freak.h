// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"

namespace floorloc {

/// Parameters of the FREAK descriptor.
struct FreakOptions {
  bool oriented = true;                ///< rotate the pattern with the image; false: keypoints get the angle 0
  bool scaled = true;                  ///< scale the pattern with the keypoint; false: as for a keypoint of 7 px
  double reach_per_size = 22.0 / 7.0;  ///< radius of the pattern including its fields, in keypoint sizes

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Fast Retina Keypoint after Alahi, Ortiz and Vandergheynst (CVPR 2012): comparisons of the mean brightness of
/// overlapping receptive fields that grow towards the rim, as in a retina. Const and thread-safe.
class Freak {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit Freak(const FreakOptions& options);

  /// Returns one row of 64 bytes (CV_8U, 512 bits) per keypoint and sets the keypoint's angle, degrees clockwise from
  /// the image's right. gray: CV_8UC1. Keypoints nearer to the image's edge than the pattern reaches are dropped.
  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const;
  cv::Mat Describe(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const;

 private:
  FreakOptions options_;
};

constexpr int kFreakBytes = 64;  ///< per descriptor

}  // namespace floorloc
