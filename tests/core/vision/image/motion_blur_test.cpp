// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/motion_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

const Eigen::Vector2d kDirection(std::cos(0.5), std::sin(0.5));

// A speckled floor, mean 128.
cv::Mat Floor() {
  cv::Mat noise(300, 400, CV_32F);
  cv::RNG random(3);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(noise, noise, {}, 1.2);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noise, mean, deviation);
  cv::Mat floor;
  noise.convertTo(floor, CV_8U, 40.0 / deviation[0], 128.0);
  return floor;
}

// The mean of the floor along a way, with the sensor's noise.
cv::Mat Moved(const cv::Mat& floor, double length_px) {
  constexpr int kSteps = 60;
  cv::Mat sum = cv::Mat::zeros(floor.size(), CV_32F);
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector2d shift = ((i + 0.5) / kSteps - 0.5) * length_px * kDirection;
    const cv::Matx23d by(1.0, 0.0, shift.x(), 0.0, 1.0, shift.y());
    cv::Mat shifted;
    cv::warpAffine(floor, shifted, by, floor.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    cv::accumulate(shifted, sum);
  }
  cv::Mat noise(floor.size(), CV_32F);
  cv::RNG random(8);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::Mat moved;
  cv::Mat(sum / kSteps + noise).convertTo(moved, CV_8U);
  return moved;
}

double Correlation(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat result;
  cv::matchTemplate(a(cv::Rect(40, 40, 320, 220)), b(cv::Rect(40, 40, 320, 220)), result, cv::TM_CCOEFF_NORMED);
  return static_cast<double>(result.at<float>(0, 0));
}

TEST(MotionBlurTest, IsUndoneAlongTheMotion) {
  const cv::Mat floor = Floor();
  for (const double length : {9.0, 14.0, 22.0}) {
    const cv::Mat blurred = Moved(floor, length);
    const auto sharp = UndoMotionBlur(blurred, kDirection);
    ASSERT_TRUE(sharp) << length;
    ASSERT_EQ(sharp->size(), floor.size());
    EXPECT_GT(Correlation(floor, *sharp), Correlation(floor, blurred) + 0.1) << length;
    const auto backwards = UndoMotionBlur(blurred, -kDirection);
    ASSERT_TRUE(backwards);
    EXPECT_GT(Correlation(*sharp, *backwards), 0.99) << length;
  }
}

TEST(MotionBlurTest, SharpImagesStayAsTheyAre) {
  const cv::Mat floor = Floor();
  EXPECT_FALSE(UndoMotionBlur(floor, kDirection));
  EXPECT_FALSE(UndoMotionBlur(Moved(floor, 4.0), kDirection));
  EXPECT_FALSE(UndoMotionBlur(cv::Mat(50, 60, CV_8UC1, cv::Scalar(128)), kDirection));
}

TEST(MotionBlurTest, OptionsAreChecked) {
  MotionBlurOptions options;
  EXPECT_NO_THROW(options.Check());
  options.max_length_px = 1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
