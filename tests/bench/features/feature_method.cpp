// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/features/feature_method.h"

#include <opencv2/features2d.hpp>

#include "core/vision/freak_star/freak.h"
#include "core/vision/freak_star/star.h"
#include "core/vision/surf/surf.h"
#include "tests/bench/features/dlib_surf.h"

namespace floorloc {
namespace {

// Low enough that only max_keypoints limits their number; the same for both SURFs, whose filters are the same.
constexpr double kSurfThreshold = 1.0;

FeatureMethod SurfMethod(const std::string& name, SurfOptions options, int max_keypoints) {
  options.threshold = kSurfThreshold;
  options.max_keypoints = max_keypoints;
  return {name, [surf = Surf(options)](const cv::Mat& gray) {
            ImageFeatures features;
            features.descriptors = surf.DetectAndDescribe(gray, cv::Mat(), &features.keypoints);
            return features;
          }};
}

FeatureMethod StarFreakMethod(int max_keypoints) {
  return {"star+freak",
          [star = Star({.threshold = 2.0, .max_keypoints = max_keypoints}), freak = Freak({})](const cv::Mat& gray) {
            ImageFeatures features;
            features.keypoints = star.Detect(gray);
            features.descriptors = freak.Describe(gray, &features.keypoints);
            return features;
          }};
}

FeatureMethod OpenCvMethod(const std::string& name, const cv::Ptr<cv::Feature2D>& feature) {
  return {name, [feature](const cv::Mat& gray) {
            ImageFeatures features;
            feature->detectAndCompute(gray, cv::noArray(), features.keypoints, features.descriptors);
            return features;
          }};
}

}  // namespace

std::vector<FeatureMethod> ComparedMethods(int max_keypoints) {
  return {SurfMethod("surf as dlib", {.octaves = 4, .layers = 4, .first_step_px = 2}, max_keypoints),
          {"dlib surf", [=](const cv::Mat& gray) { return DlibSurf(gray, kSurfThreshold, max_keypoints); }},
          SurfMethod("surf", {}, max_keypoints),
          SurfMethod("surf upright", {.upright = true}, max_keypoints),
          StarFreakMethod(max_keypoints),
          OpenCvMethod("cv sift", cv::SIFT::create(max_keypoints, 3, 0.01)),
          OpenCvMethod("cv orb", cv::ORB::create(max_keypoints, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, 5))};
}

}  // namespace floorloc
