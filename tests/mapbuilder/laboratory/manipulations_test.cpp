// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/manipulations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

// Grey noise around 120 with structures of a few pixels.
cv::Mat Noise() {
  cv::Mat noise(120, 160, CV_8UC1);
  cv::RNG rng(3);
  rng.fill(noise, cv::RNG::UNIFORM, 60, 180);
  cv::GaussianBlur(noise, noise, {}, 1.0);
  return noise;
}

double Mean(const cv::Mat& image) { return cv::mean(image)[0]; }

// Amount of detail: mean absolute Laplacian, to which the smooth veil adds nothing.
double Detail(const cv::Mat& image) {
  cv::Mat curvature;
  cv::Laplacian(image, curvature, CV_32F);
  return cv::norm(curvature, cv::NORM_L1) / static_cast<double>(image.total());
}

TEST(Manipulate, TheSameSeedDoesTheSame) {
  const cv::Mat gray = Noise();
  for (const Condition condition : kConditions) {
    const cv::Mat copy = Manipulate(gray, condition, 7);
    ASSERT_EQ(copy.type(), CV_8UC1);
    ASSERT_EQ(copy.size(), gray.size());
    EXPECT_EQ(cv::norm(copy, Manipulate(gray, condition, 7)), 0.0) << ToString(condition);
    EXPECT_GT(cv::norm(copy, gray), 0.0) << ToString(condition);
    if (condition != Condition::kRotation) {
      EXPECT_GT(cv::norm(copy, Manipulate(gray, condition, 8)), 0.0) << ToString(condition);
    }
  }
  EXPECT_EQ(cv::norm(gray, Noise()), 0.0) << "the image itself is left alone";
}

TEST(Manipulate, AShadowHalvesPartOfTheLowerHalf) {
  const cv::Mat gray = Noise();
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const cv::Mat copy = Manipulate(gray, Condition::kShadow, seed);
    int dark = 0;
    for (int v = 0; v < gray.rows; ++v) {
      for (int u = 0; u < gray.cols; ++u) {
        const int before = gray.at<std::uint8_t>(v, u);
        const int after = copy.at<std::uint8_t>(v, u);
        if (after != before) {
          ASSERT_NEAR(after, 0.5 * before, 0.51);
          ASSERT_GE(v, gray.rows / 2);
          ++dark;
        }
      }
    }
    EXPECT_GT(dark, 50) << "seed " << seed;
  }
}

TEST(Manipulate, FogWhitensAndBlurs) {
  const cv::Mat gray = Noise();
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const cv::Mat copy = Manipulate(gray, Condition::kFog, seed);
    EXPECT_GT(Mean(copy), Mean(gray) + 10);
    EXPECT_LT(Detail(copy), 0.5 * Detail(gray));
  }
}

TEST(Manipulate, BrightnessIsOneOffset) {
  const cv::Mat gray = Noise();
  bool brighter = false;
  bool darker = false;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const cv::Mat copy = Manipulate(gray, Condition::kBrightness, seed);
    const int offset = copy.at<std::uint8_t>(0, 0) - gray.at<std::uint8_t>(0, 0);
    EXPECT_LE(std::abs(offset), 51);
    cv::Mat difference;
    cv::subtract(copy, gray, difference, cv::noArray(), CV_16S);
    double least = 0.0;
    double most = 0.0;
    cv::minMaxLoc(difference, &least, &most);
    EXPECT_EQ(least, offset);
    EXPECT_EQ(most, offset);
    brighter = brighter || offset > 0;
    darker = darker || offset < 0;
  }
  EXPECT_TRUE(brighter && darker);
  const cv::Mat white(4, 4, CV_8UC1, cv::Scalar(250));
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    EXPECT_GE(Mean(Manipulate(white, Condition::kBrightness, seed)), 199) << "no overflow";
  }
}

TEST(PointInCopy, IsWhereThePixelWent) {
  const cv::Mat gray = Noise();
  const cv::Mat turned = Manipulate(gray, Condition::kRotation, 1);
  for (const cv::Point2f& position : {cv::Point2f(0, 0), cv::Point2f(17, 90), cv::Point2f(159, 119)}) {
    const cv::Point2f there = PointInCopy(position, Condition::kRotation, gray.size());
    EXPECT_EQ(turned.at<std::uint8_t>(cv::Point(there)), gray.at<std::uint8_t>(cv::Point(position)));
    EXPECT_EQ(PointInCopy(position, Condition::kFog, gray.size()), position);
  }
  EXPECT_EQ(PointInCopy({0, 0}, Condition::kRotation, gray.size()), cv::Point2f(159, 119));
}

}  // namespace
}  // namespace floorloc
