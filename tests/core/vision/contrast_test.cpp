// SPDX-License-Identifier: Apache-2.0
#include "core/vision/contrast.h"

#include <gtest/gtest.h>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

const cv::Size kSize(160, 120);

cv::Mat AllSeen() { return {kSize, CV_8UC1, cv::Scalar(255)}; }

double LargestDifference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(ContrastTest, GainAndOffsetDoNotMatter) {
  const cv::Mat dark = testing_vision::MakeTexture(kSize, 50.0, 8.0, 1);
  cv::Mat bright;
  dark.convertTo(bright, CV_8U, 2.0, 15.0);  // exact in 8 bits
  const cv::Mat from_dark = NormalizeContrast(dark, AllSeen(), {});
  EXPECT_LE(LargestDifference(from_dark, NormalizeContrast(bright, AllSeen(), {})), 1.0);
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
  cv::absdiff(NormalizeContrast(flat, AllSeen(), {}), NormalizeContrast(lit, AllSeen(), {}), difference);
  const cv::Rect inside(16, 16, kSize.width - 32, kSize.height - 32);  // a mirrored slope is not a slope
  EXPECT_LT(cv::mean(difference(inside))[0], 6.0);
}

TEST(ContrastTest, UnseenPixelsAreGrey) {
  cv::Mat mask = AllSeen();
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

TEST(ContrastTest, NoiseOfAPlainPictureStaysSmall) {
  const cv::Mat plain = testing_vision::MakeTexture(kSize, 128.0, 0.3, 4);  // no texture, just rounding
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(NormalizeContrast(plain, AllSeen(), {}), mean, deviation);
  EXPECT_LT(deviation[0], 20.0);
}

}  // namespace
}  // namespace floorloc
