// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/contrast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

const cv::Size kSize(160, 120);

cv::Mat FullMask() { return {kSize, CV_8UC1, cv::Scalar(255)}; }

double LargestDifference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

// Reference implementation of the definition, per pixel in double.
cv::Mat PlainlyNormalized(const cv::Mat& gray, const ContrastOptions& options) {
  cv::Mat levels;
  gray.convertTo(levels, CV_64F);
  if (options.smooth_sigma_px > 0.0) {
    const int side = 2 * static_cast<int>(std::ceil(3.0 * options.smooth_sigma_px)) + 1;
    cv::GaussianBlur(levels, levels, {side, side}, options.smooth_sigma_px, 0.0, cv::BORDER_REFLECT);
  }
  cv::Mat normalized(gray.size(), CV_8UC1);
  const int radius = options.radius_px;
  for (int v = 0; v < gray.rows; ++v) {
    for (int u = 0; u < gray.cols; ++u) {
      cv::Mat window(2 * radius + 1, 2 * radius + 1, CV_64F);
      for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x) {
          window.at<double>(y + radius, x + radius) =
              levels.at<double>(cv::borderInterpolate(v + y, gray.rows, cv::BORDER_REFLECT),
                                cv::borderInterpolate(u + x, gray.cols, cv::BORDER_REFLECT));
        }
      }
      cv::Scalar mean, deviation;
      cv::meanStdDev(window, mean, deviation);
      const double value = 128.0 + 40.0 * (levels.at<double>(v, u) - mean[0]) / std::max(deviation[0], 1.0);
      normalized.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  return normalized;
}

void ExpectAsDefined(const cv::Mat& gray, const ContrastOptions& options) {
  const cv::Mat seen(gray.size(), CV_8UC1, cv::Scalar(255));
  // A value near the middle of two grey levels may be rounded differently in float and double.
  EXPECT_LE(LargestDifference(NormalizeContrast(gray, seen, options), PlainlyNormalized(gray, options)), 1.0)
      << gray.size() << ", radius " << options.radius_px << ", sigma " << options.smooth_sigma_px;
}

TEST(ContrastTest, IsWhatItsDefinitionSays) {
  const cv::Mat gray = testing_vision::MakeTexture({83, 61}, 110.0, 30.0, 5);
  for (const int radius : {1, 2, 3, 7, 15, 20}) {
    ExpectAsDefined(gray, {radius, 1.0});
  }
  ExpectAsDefined(gray, {15, 0.0});
  ExpectAsDefined(gray, {15, 2.5});
}

TEST(ContrastTest, IsWhatItsDefinitionSaysOnImagesSmallerThanTheWindow) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(2, 40), cv::Size(40, 2), cv::Size(9, 7), cv::Size(16, 15)}) {
    cv::Mat gray(size, CV_8UC1);
    cv::RNG(6).fill(gray, cv::RNG::UNIFORM, 60, 200);
    ExpectAsDefined(gray, {15, 1.0});
    ExpectAsDefined(gray, {4, 0.0});
  }
  EXPECT_TRUE(NormalizeContrast(cv::Mat(0, 0, CV_8UC1), cv::Mat(0, 0, CV_8UC1), {}).empty());
}

TEST(ContrastTest, BlackAndWhiteAboveAndLeftLeavesNoTraceOnPlainFloor) {
  cv::Mat gray = testing_vision::MakeTexture({80, 500}, 128.0, 4.0, 7);
  cv::RNG random(8);
  for (cv::Mat part : {gray.rowRange(0, 60), gray.colRange(0, 20)}) {
    random.fill(part, cv::RNG::UNIFORM, 0, 2);
    part *= 255;
  }
  ExpectAsDefined(gray, {15, 0.0});
}

TEST(ContrastTest, ManyRowsOfABrightPlainFloorAddUp) {
  ExpectAsDefined(testing_vision::MakeTexture({40, 1500}, 250.0, 1.5, 9), {15, 1.0});
}

TEST(ContrastTest, GainAndOffsetDoNotMatter) {
  const cv::Mat dark = testing_vision::MakeTexture(kSize, 50.0, 8.0, 1);
  cv::Mat bright;
  dark.convertTo(bright, CV_8U, 2.0, 15.0);  // exact in 8 bits
  const cv::Mat from_dark = NormalizeContrast(dark, FullMask(), {});
  EXPECT_LE(LargestDifference(from_dark, NormalizeContrast(bright, FullMask(), {})), 1.0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(from_dark, mean, deviation);
  EXPECT_NEAR(mean[0], 128.0, 3.0);
  EXPECT_NEAR(deviation[0], 40.0, 6.0);
}

TEST(ContrastTest, SlowLightDoesNotMatter) {
  const cv::Mat flat = testing_vision::MakeTexture(kSize, 100.0, 10.0, 2);
  cv::Mat lit;
  flat.convertTo(lit, CV_32F);
  for (int u = 0; u < lit.cols; ++u) {
    lit.col(u) += 0.5 * u;
  }
  lit.convertTo(lit, CV_8U);
  cv::Mat difference;
  cv::absdiff(NormalizeContrast(flat, FullMask(), {}), NormalizeContrast(lit, FullMask(), {}), difference);
  const cv::Rect inside(16, 16, kSize.width - 32,
                        kSize.height - 32);  // at the border the mirrored light gradient is not a gradient
  EXPECT_LT(cv::mean(difference(inside))[0], 6.0);
}

TEST(ContrastTest, UnseenPixelsAreGrey) {
  cv::Mat mask = FullMask();
  mask(cv::Rect(0, 0, 40, 120)) = 0;
  cv::Mat gray = testing_vision::MakeTexture(kSize, 100.0, 20.0, 3);
  gray.setTo(0, mask == 0);
  const cv::Mat normalized = NormalizeContrast(gray, mask, {});
  EXPECT_EQ(cv::norm(normalized(cv::Rect(0, 0, 40, 120)), cv::Mat(120, 40, CV_8UC1, cv::Scalar(128)), cv::NORM_INF), 0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(normalized(cv::Rect(60, 0, 100, 120)), mean, deviation);
  EXPECT_GT(deviation[0], 30.0);
}

TEST(ContrastTest, NoiseOfAPlainImageStaysSmall) {
  const cv::Mat plain = testing_vision::MakeTexture(kSize, 128.0, 0.3, 4);  // no texture, just rounding
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(NormalizeContrast(plain, FullMask(), {}), mean, deviation);
  EXPECT_LT(deviation[0], 20.0);
}

}  // namespace
}  // namespace floorloc
