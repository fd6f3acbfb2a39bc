// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "core/vision/features/keypoint_selection.h"
#include "core/vision/surf/surf_descriptor.h"
#include "core/vision/surf/surf_detector.h"
#include "core/vision/surf/surf_orientation.h"

namespace floorloc {

bool SurfAvailable() { return true; }

Surf::Surf(const SurfOptions& options) : options_(options) { options_.Check(); }

std::vector<cv::KeyPoint> Surf::Find(const IntegralImage& integral, const cv::Mat& mask) const {
  std::vector<cv::KeyPoint> keypoints = DetectFastHessian(integral, options_);
  KeepStrongest(mask, options_.max_keypoints, &keypoints);
  return keypoints;
}

void Surf::Orient(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const {
  BoxSampler sampler(integral);
  Orient(&sampler, keypoints);
}

void Surf::Orient(BoxSampler* sampler, std::vector<cv::KeyPoint>* keypoints) const {
  for (cv::KeyPoint& keypoint : *keypoints) {
    if (options_.upright) {
      keypoint.angle = 0.0F;
    } else if (keypoint.angle < 0.0F) {
      keypoint.angle = SurfOrientation(keypoint, sampler);
    }
  }
}

cv::Mat Surf::Describe(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const {
  DropNearEdge({integral.width(), integral.height()}, SurfReachPx, keypoints);
  BoxSampler sampler(integral);
  Orient(&sampler, keypoints);
  cv::Mat descriptors(static_cast<int>(keypoints->size()), kSurfLength, CV_32FC1);
  for (int i = 0; i < descriptors.rows; ++i) {
    DescribeSurf((*keypoints)[static_cast<std::size_t>(i)], &sampler, descriptors.ptr<float>(i));
  }
  return descriptors;
}

std::vector<cv::KeyPoint> Surf::Detect(const cv::Mat& gray, const cv::Mat& mask) const {
  const IntegralImage integral(gray);
  std::vector<cv::KeyPoint> keypoints = Find(integral, mask);
  Orient(integral, &keypoints);
  return keypoints;
}

cv::Mat Surf::Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const {
  return Describe(IntegralImage(gray), keypoints);
}

cv::Mat Surf::DetectAndDescribe(const cv::Mat& gray, const cv::Mat& mask, std::vector<cv::KeyPoint>* keypoints) const {
  const IntegralImage integral(gray);
  *keypoints = Find(integral, mask);
  return Describe(integral, keypoints);
}

}  // namespace floorloc
