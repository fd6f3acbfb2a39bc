// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/texture_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

cv::Mat Noise(cv::Size size, double mean, double sigma) {
  cv::Mat gray(size, CV_8UC1);
  cv::RNG(3).fill(gray, cv::RNG::NORMAL, mean, sigma);
  return gray;
}

// The article's formulas, pixel by pixel.
TextureFeatures ByDefinition(const cv::Mat& gray) {
  std::map<int, double> p;
  for (int v = 0; v < gray.rows; ++v) {
    for (int u = 0; u < gray.cols; ++u) {
      p[gray.at<std::uint8_t>(v, u)] += 1.0 / static_cast<double>(gray.total());
    }
  }
  double mean = 0.0, variance = 0.0, energy = 0.0, outliers = 0.0;
  for (const auto& [m, share] : p) {
    mean += m * share;
    energy += share * share;
  }
  for (const auto& [m, share] : p) {
    variance += (m - mean) * (m - mean) * share;
  }
  for (const auto& [m, share] : p) {
    outliers += std::abs(m - mean) > 3.0 * std::sqrt(variance) ? share : 0.0;
  }
  return {mean, variance, energy, outliers};
}

TEST(TextureFeatures, AreThoseOfTheDefinition) {
  cv::Mat gray = Noise({83, 61}, 120.0, 12.0);
  gray(cv::Rect(3, 4, 5, 5)).setTo(250);
  gray(cv::Rect(60, 40, 4, 3)).setTo(2);
  const TextureFeatures expected = ByDefinition(gray);
  const TextureFeatures found = MeasureTexture(gray);
  EXPECT_TRUE(found.isApprox(expected, 1e-9)) << found.transpose() << "\n" << expected.transpose();
  EXPECT_GT(found(3), 0.006);
}

TEST(TextureFeatures, OfOneGreyLevelHaveNoSpread) {
  EXPECT_EQ(MeasureTexture(cv::Mat(7, 9, CV_8UC1, cv::Scalar(42))), TextureFeatures(42.0, 0.0, 1.0, 0.0));
}

TEST(TextureFeatures, EnergyOfAGaussianFollowsItsDeviation) {
  const TextureFeatures found = MeasureTexture(Noise({320, 240}, 128.0, 15.0));
  EXPECT_NEAR(found(2) * 15.0, 0.5 / std::sqrt(std::numbers::pi), 0.01);
}

TEST(TextureBlocks, ThreeByFourOfWhichTheUppermostCanBeLeftOut) {
  const cv::Mat gray = Noise({321, 241}, 100.0, 5.0);
  const std::vector<TextureBlock> all = MeasureTextureBlocks(gray);
  ASSERT_EQ(all.size(), 12U);
  int area = 0;
  for (const TextureBlock& block : all) {
    area += block.area.area();
    EXPECT_EQ(block.features, MeasureTexture(gray(block.area)));
  }
  EXPECT_EQ(area, gray.size().area());
  const std::vector<TextureBlock> lower = MeasureTextureBlocks(gray, {.skipped_rows = 1});
  ASSERT_EQ(lower.size(), 8U);
  EXPECT_EQ(lower[0].area, all[4].area);
}

TEST(TextureBlocks, AGridMustLeaveSomething) {
  EXPECT_THROW((TextureGrid{.rows = 3, .skipped_rows = 3}).Check(), std::invalid_argument);
  EXPECT_THROW((TextureGrid{.columns = 0}).Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
