// SPDX-License-Identifier: Apache-2.0
// Replaces surf.cpp in builds without SURF: no Surf can be constructed, so its other members are never called.
#include <cassert>
#include <stdexcept>

#include "core/vision/surf/surf.h"

namespace floorloc {

bool SurfAvailable() { return false; }

Surf::Surf(const SurfOptions& /*options*/) {
  throw std::invalid_argument(
      "this build has no SURF; choose another extractor, or build floorloc with -DFLOORLOC_WITH_SURF=ON");
}

std::vector<cv::KeyPoint> Surf::Find(const IntegralImage& /*integral*/, const cv::Mat& /*mask*/) const {
  assert(false);
  return {};
}

void Surf::Orient(const IntegralImage& /*integral*/, std::vector<cv::KeyPoint>* /*keypoints*/) const { assert(false); }

void Surf::Orient(BoxSampler* /*sampler*/, std::vector<cv::KeyPoint>* /*keypoints*/) const { assert(false); }

cv::Mat Surf::Describe(const IntegralImage& /*integral*/, std::vector<cv::KeyPoint>* /*keypoints*/) const {
  assert(false);
  return {};
}

std::vector<cv::KeyPoint> Surf::Detect(const cv::Mat& /*gray*/, const cv::Mat& /*mask*/) const {
  assert(false);
  return {};
}

cv::Mat Surf::Describe(const cv::Mat& /*gray*/, std::vector<cv::KeyPoint>* /*keypoints*/) const {
  assert(false);
  return {};
}

cv::Mat Surf::DetectAndDescribe(const cv::Mat& /*gray*/, const cv::Mat& /*mask*/,
                                std::vector<cv::KeyPoint>* /*keypoints*/) const {
  assert(false);
  return {};
}

}  // namespace floorloc
