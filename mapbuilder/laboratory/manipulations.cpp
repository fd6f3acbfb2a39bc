// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/manipulations.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace floorloc {
namespace {

double Uniform(std::mt19937& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

cv::Mat WithShadow(const cv::Mat& gray, std::mt19937& rng) {
  constexpr int kCorners = 5;
  constexpr double kDarkness = 0.5;
  cv::Mat mask = cv::Mat::zeros(gray.size(), CV_8UC1);
  const int shadows = std::uniform_int_distribution<int>(1, 2)(rng);
  for (int shadow = 0; shadow < shadows; ++shadow) {
    std::vector<cv::Point> polygon;
    for (int corner = 0; corner < kCorners; ++corner) {
      const int u = static_cast<int>(Uniform(rng, 0.0, gray.cols));
      polygon.emplace_back(u, static_cast<int>(Uniform(rng, 0.5 * gray.rows, gray.rows)));
    }
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{polygon}, cv::Scalar(255));
  }
  cv::Mat copy = gray.clone();
  cv::Mat dark;
  gray.convertTo(dark, CV_8U, kDarkness);
  dark.copyTo(copy, mask);
  return copy;
}

// Smooth random field, 0 to 1, interpolated from coarse noise.
cv::Mat Patches(const cv::Size& size, std::mt19937& rng) {
  constexpr int kCoarse = 5;
  cv::Mat coarse(kCoarse, kCoarse, CV_32F);
  for (int v = 0; v < kCoarse; ++v) {
    for (int u = 0; u < kCoarse; ++u) {
      coarse.at<float>(v, u) = static_cast<float>(Uniform(rng, 0.0, 1.0));
    }
  }
  cv::Mat patches;
  cv::resize(coarse, patches, size, 0, 0, cv::INTER_LINEAR);
  return patches;
}

cv::Mat WithFog(const cv::Mat& gray, std::mt19937& rng) {
  constexpr double kWhite = 255.0;
  const double strength = Uniform(rng, 0.3, 1.0);
  // The veil's opacity is 0.4 to 0.8 times the strength.
  const cv::Mat veil = strength * (0.4 + 0.4 * Patches(gray.size(), rng));
  cv::Mat copy;
  gray.convertTo(copy, CV_32F);
  copy = copy + veil.mul(kWhite - copy);
  const int side = std::max(3, static_cast<int>(strength * gray.cols / 30.0)) | 1;
  cv::blur(copy, copy, {side, side});
  copy.convertTo(copy, CV_8U);
  return copy;
}

cv::Mat WithBrightness(const cv::Mat& gray, std::mt19937& rng) {
  constexpr double kMaxGreyLevels = 0.2 * 255.0;
  cv::Mat copy;
  gray.convertTo(copy, CV_8U, 1.0, Uniform(rng, -kMaxGreyLevels, kMaxGreyLevels));
  return copy;
}

}  // namespace

const char* ToString(Condition condition) {
  switch (condition) {
    case Condition::kShadow:
      return "shadow";
    case Condition::kFog:
      return "fog";
    case Condition::kBrightness:
      return "brightness";
    case Condition::kRotation:
      return "rotation";
  }
  assert(false);
  return "";
}

cv::Mat Manipulate(const cv::Mat& gray, Condition condition, std::uint32_t seed) {
  std::mt19937 rng(seed);
  switch (condition) {
    case Condition::kShadow:
      return WithShadow(gray, rng);
    case Condition::kFog:
      return WithFog(gray, rng);
    case Condition::kBrightness:
      return WithBrightness(gray, rng);
    case Condition::kRotation: {
      cv::Mat copy;
      cv::rotate(gray, copy, cv::ROTATE_180);
      return copy;
    }
  }
  assert(false);
  return {};
}

cv::Point2f PointInCopy(const cv::Point2f& position, Condition condition, const cv::Size& size) {
  if (condition != Condition::kRotation) {
    return position;
  }
  return {static_cast<float>(size.width - 1) - position.x, static_cast<float>(size.height - 1) - position.y};
}

}  // namespace floorloc
