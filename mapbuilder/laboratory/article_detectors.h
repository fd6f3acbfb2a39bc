// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// The detectors that Otsu et al. (2013) compare. As there nothing but detection is timed: keypoints get no
/// orientation.
enum class ArticleDetector { kHarris, kShiTomasi, kFast, kDog, kFastHessian, kStar };
constexpr std::array<ArticleDetector, 6> kArticleDetectors = {
    ArticleDetector::kHarris, ArticleDetector::kShiTomasi,   ArticleDetector::kFast,
    ArticleDetector::kDog,    ArticleDetector::kFastHessian, ArticleDetector::kStar};
/// "Harris", "Shi-Tomasi", "FAST", "DoG", "Fast Hessian", "STAR"
const char* ToString(ArticleDetector detector);

/// Parameters of table A1 that depend on the contrast of the floor.
struct ArticleDetectorOptions {
  int fast_threshold = 80;                ///< grey levels
  double fast_hessian_threshold = 400.0;  ///< of OpenCV's SURF
  double dog_contrast_threshold = 0.01;   ///< of OpenCV's SIFT, image from 0 to 1
  double star_response_threshold = 6.0;   ///< grey levels

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

using DetectFunction = std::function<std::vector<cv::KeyPoint>(const cv::Mat& gray, const cv::Mat& mask)>;

/// With the other parameters of table A1. gray: CV_8UC1. mask: CV_8UC1, 0 where no keypoint may be. Empty: the detector
/// was left out of this build.
DetectFunction MakeArticleDetector(ArticleDetector detector, const ArticleDetectorOptions& options = {});

}  // namespace floorloc
