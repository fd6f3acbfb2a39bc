// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/article_detectors.h"

#include <memory>
#include <opencv2/features2d.hpp>

#include "core/geometry/option_check.h"
#include "core/vision/freak_star/star.h"
#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

constexpr int kAll = 1'000'000;  // OpenCV's "no limit"

DetectFunction FromOpenCv(const cv::Ptr<cv::Feature2D>& feature) {
  return [feature](const cv::Mat& gray, const cv::Mat& mask) {
    std::vector<cv::KeyPoint> keypoints;
    feature->detect(gray, keypoints, mask);
    return keypoints;
  };
}

// OpenCV's SIFT takes as many octaves as fit.
DetectFunction Dog(double contrast_threshold) {
  constexpr int kOctaves = 4;
  const DetectFunction sift = FromOpenCv(cv::SIFT::create(0, 3, contrast_threshold, 10.0, 1.6));
  return [sift](const cv::Mat& gray, const cv::Mat& mask) {
    std::vector<cv::KeyPoint> keypoints = sift(gray, mask);
    std::erase_if(keypoints, [](const cv::KeyPoint& k) {
      const auto octave = static_cast<signed char>(k.octave & 0xFF);  // -1: the doubled image
      return octave + 1 >= kOctaves;
    });
    return keypoints;
  };
}

// OpenCV divides the sum of a box by the box's area, ours by the filter's: 15 and 81 pixels in the smallest filter, and
// the determinant is a product of two.
DetectFunction FastHessian(double opencv_threshold) {
  constexpr double kOursFromOpenCv = (15.0 / 81.0) * (15.0 / 81.0);
  SurfOptions options;
  options.octaves = 3;
  options.layers = 4;
  options.threshold = opencv_threshold * kOursFromOpenCv;
  options.upright = true;
  const auto surf = std::make_shared<Surf>(options);
  return [surf](const cv::Mat& gray, const cv::Mat& mask) { return surf->Find(IntegralImage(gray), mask); };
}

// A largest scale of 16 is an outer star of 33 pixels. Ours has one threshold for lines.
DetectFunction StarOfArticle(double threshold) {
  StarOptions options;
  options.threshold = threshold;
  options.max_size_px = 33;
  options.line_ratio = 10.0;
  const auto star = std::make_shared<Star>(options);
  return [star](const cv::Mat& gray, const cv::Mat& mask) { return star->Detect(gray, mask); };
}

}  // namespace

const char* ToString(ArticleDetector detector) {
  switch (detector) {
    case ArticleDetector::kHarris:
      return "Harris";
    case ArticleDetector::kShiTomasi:
      return "Shi-Tomasi";
    case ArticleDetector::kFast:
      return "FAST";
    case ArticleDetector::kDog:
      return "DoG";
    case ArticleDetector::kFastHessian:
      return "Fast Hessian";
    case ArticleDetector::kStar:
      return "STAR";
  }
  return "";
}

void ArticleDetectorOptions::Check() const {
  RequireOption(fast_threshold >= 1 && fast_threshold <= 254, "fast_threshold must be 1 to 254");
  RequireOption(fast_hessian_threshold > 0.0, "fast_hessian_threshold must be positive");
  RequireOption(dog_contrast_threshold > 0.0, "dog_contrast_threshold must be positive");
  RequireOption(star_response_threshold > 0.0, "star_response_threshold must be positive");
}

DetectFunction MakeArticleDetector(ArticleDetector detector, const ArticleDetectorOptions& options) {
  options.Check();
  switch (detector) {
    case ArticleDetector::kHarris:
      return FromOpenCv(cv::GFTTDetector::create(kAll, 0.01, 5.0, 3, true, 0.04));
    case ArticleDetector::kShiTomasi:
      return FromOpenCv(cv::GFTTDetector::create(kAll, 0.01, 5.0));
    case ArticleDetector::kFast:
      return FromOpenCv(cv::FastFeatureDetector::create(options.fast_threshold));
    case ArticleDetector::kDog:
      return Dog(options.dog_contrast_threshold);
    case ArticleDetector::kFastHessian:
      return SurfAvailable() ? FastHessian(options.fast_hessian_threshold) : DetectFunction();
    case ArticleDetector::kStar:
      return StarOfArticle(options.star_response_threshold);
  }
  return {};
}

}  // namespace floorloc
