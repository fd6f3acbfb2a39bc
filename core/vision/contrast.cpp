// SPDX-License-Identifier: Apache-2.0
#include "core/vision/contrast.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr float kMiddle = 128.0F;
constexpr float kGain = 40.0F;
// Deviations below the noise of a camera are not amplified to full contrast.
constexpr float kMinDeviation = 1.0F;

cv::Mat Smooth(const cv::Mat& gray, double sigma_px) {
  cv::Mat smooth;
  gray.convertTo(smooth, CV_32F);
  if (sigma_px > 0.0) {
    cv::GaussianBlur(smooth, smooth, cv::Size(), sigma_px, sigma_px, cv::BORDER_REFLECT);
  }
  return smooth;
}

}  // namespace

cv::Mat NormalizeContrast(const cv::Mat& gray, const cv::Mat& mask, const ContrastOptions& options) {
  const cv::Mat smooth = Smooth(gray, options.smooth_sigma_px);
  const cv::Size window(2 * options.radius_px + 1, 2 * options.radius_px + 1);
  cv::Mat mean;
  cv::Mat mean_square;
  cv::boxFilter(smooth, mean, CV_32F, window, cv::Point(-1, -1), true, cv::BORDER_REFLECT);
  cv::sqrBoxFilter(smooth, mean_square, CV_32F, window, cv::Point(-1, -1), true, cv::BORDER_REFLECT);
  cv::Mat normalized(gray.size(), CV_8UC1);
  for (int v = 0; v < gray.rows; ++v) {
    const float* in = smooth.ptr<float>(v);
    const float* mu = mean.ptr<float>(v);
    const float* square = mean_square.ptr<float>(v);
    const std::uint8_t* seen = mask.ptr<std::uint8_t>(v);
    std::uint8_t* out = normalized.ptr<std::uint8_t>(v);
    for (int u = 0; u < gray.cols; ++u) {
      const float variance = std::max(square[u] - mu[u] * mu[u], kMinDeviation * kMinDeviation);
      const float value = seen[u] != 0 ? kMiddle + kGain * (in[u] - mu[u]) / std::sqrt(variance) : kMiddle;
      out[u] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
    }
  }
  return normalized;
}

}  // namespace floorloc
