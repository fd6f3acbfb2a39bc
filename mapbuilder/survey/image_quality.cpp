// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/image_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>

namespace floorloc {
namespace {

constexpr int kClippedGray = 250;
constexpr double kBrightShare = 0.1;

// Squared difference from the 3x3 mean at half resolution, where sensor noise has less influence.
cv::Mat FineEnergy(const cv::Mat& gray) {
  cv::Mat half;
  cv::resize(gray, half, {std::max(1, gray.cols / 2), std::max(1, gray.rows / 2)}, 0, 0, cv::INTER_AREA);
  half.convertTo(half, CV_32F);
  cv::Mat mean;
  cv::blur(half, mean, {3, 3});
  const cv::Mat fine = half - mean;
  return fine.mul(fine);
}

float MedianSharpness(const GroundImage& image) {
  const cv::Size cells(std::max(1, image.gray.cols / kQualityCellPx), std::max(1, image.gray.rows / kQualityCellPx));
  cv::Mat energy;
  cv::Mat brightness;
  cv::Mat cell_mask;
  cv::resize(FineEnergy(image.gray), energy, cells, 0, 0, cv::INTER_AREA);
  cv::resize(image.gray, brightness, cells, 0, 0, cv::INTER_AREA);
  cv::resize(image.mask, cell_mask, cells, 0, 0, cv::INTER_AREA);
  std::vector<float> sharpness;
  for (int row = 0; row < cells.height; ++row) {
    for (int column = 0; column < cells.width; ++column) {
      if (cell_mask.at<std::uint8_t>(row, column) == 255) {
        const float gray = std::max<float>(1.0F, brightness.at<std::uint8_t>(row, column));
        sharpness.push_back(std::sqrt(energy.at<float>(row, column)) / gray);
      }
    }
  }
  if (sharpness.empty()) {
    return 0.0F;
  }
  const auto middle = sharpness.begin() + static_cast<std::ptrdiff_t>(sharpness.size() / 2);
  std::nth_element(sharpness.begin(), middle, sharpness.end());
  return *middle;
}

std::array<int, 256> Histogram(const GroundImage& image) {
  std::array<int, 256> counts{};
  for (int row = 0; row < image.gray.rows; ++row) {
    const auto* gray = image.gray.ptr<std::uint8_t>(row);
    const auto* mask = image.mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.gray.cols; ++column) {
      counts[gray[column]] += mask[column] != 0 ? 1 : 0;
    }
  }
  return counts;
}

}  // namespace

ImageQuality MeasureQuality(const GroundImage& image) {
  ImageQuality quality;
  quality.sharpness = MedianSharpness(image);
  const std::array<int, 256> counts = Histogram(image);
  int total = 0;
  for (const int count : counts) {
    total += count;
  }
  int brighter = 0;
  int level = 255;
  for (; level > 0 && brighter + counts[static_cast<std::size_t>(level)] <= kBrightShare * total; --level) {
    brighter += counts[static_cast<std::size_t>(level)];
  }
  quality.bright_level = static_cast<float>(level);
  int clipped = 0;
  for (std::size_t gray = kClippedGray; gray < counts.size(); ++gray) {
    clipped += counts[gray];
  }
  quality.clipped_share = total > 0 ? static_cast<float>(clipped) / static_cast<float>(total) : 0.0F;
  const cv::Mat pixels = image.gray.isContinuous() ? image.gray : image.gray.clone();
  quality.pixel_hash = std::hash<std::string_view>()({reinterpret_cast<const char*>(pixels.data), pixels.total()});
  return quality;
}

}  // namespace floorloc
