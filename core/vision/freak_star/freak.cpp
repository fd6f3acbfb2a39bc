// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/freak.h"

#include <stdexcept>

#include "core/vision/features/keypoint_selection.h"
#include "core/vision/freak_star/freak_pairs.h"
#include "core/vision/freak_star/freak_pattern.h"

namespace floorloc {
namespace {

constexpr float kUnscaledSizePx = 7.0F;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

float ReachPx(const FreakOptions& options, const cv::KeyPoint& keypoint) {
  return static_cast<float>(options.reach_per_size) * (options.scaled ? keypoint.size : kUnscaledSizePx);
}

void Compare(const FreakFields& fields, std::uint8_t* descriptor) {
  for (std::size_t byte = 0; byte < kFreakBytes; ++byte) {
    unsigned bits = 0;
    for (std::size_t bit = 0; bit < 8; ++bit) {
      const FreakPair& pair = kFreakPairs[8 * byte + bit];
      bits |= static_cast<unsigned>(fields[pair.brighter] > fields[pair.darker]) << bit;
    }
    descriptor[byte] = static_cast<std::uint8_t>(bits);
  }
}

}  // namespace

void FreakOptions::Check() const {
  Require(reach_per_size >= 0.5 && reach_per_size <= 100.0, "reach_per_size must be 0.5 to 100");
}

Freak::Freak(const FreakOptions& options) : options_(options) { options_.Check(); }

cv::Mat Freak::Describe(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const {
  DropNearEdge(
      {integral.width(), integral.height()}, [this](const cv::KeyPoint& k) { return ReachPx(options_, k); }, keypoints);
  BoxSampler sampler(integral);
  cv::Mat descriptors(static_cast<int>(keypoints->size()), kFreakBytes, CV_8UC1);
  for (int i = 0; i < descriptors.rows; ++i) {
    cv::KeyPoint& keypoint = (*keypoints)[static_cast<std::size_t>(i)];
    FreakPatternPose pose{keypoint.pt, ReachPx(options_, keypoint), 0.0F};
    FreakFields fields = SampleFreakFields(pose, &sampler);
    if (options_.oriented) {
      pose.angle_deg = FreakOrientation(fields);
      fields = SampleFreakFields(pose, &sampler);
    }
    keypoint.angle = pose.angle_deg;
    Compare(fields, descriptors.ptr(i));
  }
  return descriptors;
}

cv::Mat Freak::Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const {
  return Describe(IntegralImage(gray), keypoints);
}

}  // namespace floorloc
