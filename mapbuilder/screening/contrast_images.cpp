// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/contrast_images.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

// Darker than this share of the image's brightness, noise would look like contrast.
constexpr double kDarkShare = 0.5;

// The median's steps of one grey value are smoothed.
constexpr int kSmoothLightPx = 3;

}  // namespace

cv::Size HalfSize(const cv::Size& size) { return {std::max(1, size.width / 2), std::max(1, size.height / 2)}; }

cv::Mat ToHalfSize(const cv::Mat& image) {
  cv::Mat half;
  cv::resize(image, half, HalfSize(image.size()), 0, 0, cv::INTER_AREA);
  return half;
}

cv::Mat ToSize(const cv::Mat& image, const cv::Size& size) {
  cv::Mat resized;
  cv::resize(image, resized, size, 0, 0, cv::INTER_NEAREST);
  return resized;
}

cv::Mat WindowMean(const cv::Mat& image, int window_px) {
  cv::Mat mean;
  cv::blur(image, mean, {window_px, window_px}, {-1, -1}, cv::BORDER_REFLECT);
  return mean;
}

cv::Mat WindowCorrelation(const cv::Mat& a, const cv::Mat& b, int window_px, double noise) {
  const double variance = noise * noise;
  cv::Mat sigmas;
  cv::sqrt((WindowMean(a.mul(a), window_px) + variance).mul(WindowMean(b.mul(b), window_px) + variance), sigmas);
  cv::Mat correlation = WindowMean(a.mul(b), window_px) / sigmas;
  return correlation;
}

cv::Mat StructureContrast(const cv::Mat& raw, const cv::Size& size, int light_px) {
  cv::Mat image;
  cv::resize(raw, image, size, 0, 0, cv::INTER_AREA);
  cv::Mat light = ToHalfSize(image);
  cv::medianBlur(light, light, light_px);
  light.convertTo(light, CV_32F);
  cv::resize(WindowMean(light, kSmoothLightPx), light, size, 0, 0, cv::INTER_LINEAR);
  image.convertTo(image, CV_32F);
  cv::Mat contrast = (image - light) / cv::max(light, kDarkShare * cv::mean(image)[0] + 1.0);
  return contrast;
}

cv::Mat InView(const cv::Mat& map, int window_px) {
  cv::Mat inside;
  cv::inRange(map, cv::Scalar(0.0, 0.0), cv::Scalar(map.cols - 1.0, map.rows - 1.0), inside);
  cv::erode(inside, inside, cv::Mat::ones(window_px, window_px, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar::all(255));
  return inside;
}

}  // namespace floorloc
