// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/hessian_detector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

constexpr int kBorder = 10;
const cv::Size kSize(90, 70);

// A Gaussian blob of the given height, sigma 3 px, on a grey background.
cv::Mat Spot(const cv::Size& size, const cv::Point2d& middle, double height) {
  constexpr double kSigmaPx = 3.0;
  cv::Mat smooth(size, CV_32F);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double square = std::pow(u - middle.x, 2) + std::pow(v - middle.y, 2);
      smooth.at<float>(v, u) = static_cast<float>(128.0 + height * std::exp(-0.5 * square / (kSigmaPx * kSigmaPx)));
    }
  }
  return smooth;
}

TEST(HessianDetectorTest, FindsASpotToAFractionOfAPixel) {
  for (const double height : {60.0, -60.0}) {
    for (const double du : {-0.4, -0.2, 0.0, 0.3, 0.45}) {
      for (const double dv : {-0.35, 0.0, 0.25}) {
        const cv::Point2d middle(41.0 + du, 33.0 + dv);
        const auto found = DetectHessian(Spot(kSize, middle, height), kBorder, 0.5F);
        ASSERT_EQ(found.size(), 1U) << middle << " " << height;
        EXPECT_NEAR(found[0].pt.x, middle.x, 0.1);
        EXPECT_NEAR(found[0].pt.y, middle.y, 0.1);
      }
    }
  }
}

TEST(HessianDetectorTest, ResponseIsTheDeterminant) {
  // At the centre of a Gaussian of height h and sigma s both second derivatives are -h / s^2; finite differences over
  // pixels are slightly smaller.
  const auto found = DetectHessian(Spot(kSize, {41.0, 33.0}, 90.0), kBorder, 0.5F);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].response, 100.0, 8.0);
  EXPECT_TRUE(DetectHessian(Spot(kSize, {41.0, 33.0}, 90.0), kBorder, 110.0F).empty());
}

TEST(HessianDetectorTest, FindsNothingOnPlainGroundOrSlopes) {
  EXPECT_TRUE(DetectHessian(cv::Mat(kSize, CV_32F, cv::Scalar(128.0)), kBorder, 0.0F).empty());
  cv::Mat slope(kSize, CV_32F);
  for (int u = 0; u < slope.cols; ++u) {
    slope.col(u) = 2.0 * u;
  }
  EXPECT_TRUE(DetectHessian(slope, kBorder, 0.0F).empty());
}

TEST(HessianDetectorTest, ALineIsNoSpot) {
  for (const double degrees : {0.0, 30.0, 45.0, 90.0, 135.0}) {
    const double c = std::cos(degrees * CV_PI / 180.0);
    const double s = std::sin(degrees * CV_PI / 180.0);
    cv::Mat line(kSize, CV_32F);
    for (int v = 0; v < line.rows; ++v) {
      for (int u = 0; u < line.cols; ++u) {
        const double across = c * (u - 45.0) + s * (v - 35.0);
        line.at<float>(v, u) = static_cast<float>(128.0 + 60.0 * std::exp(-0.5 * std::pow(across / 3.0, 2)));
      }
    }
    EXPECT_TRUE(DetectHessian(line, kBorder, 1.0F).empty()) << degrees;  // a blob of that height has 42
  }
}

TEST(HessianDetectorTest, RespectsTheBorder) {
  const int right = kSize.width - 1;
  const int bottom = kSize.height - 1;
  for (const cv::Point2d& inside : {cv::Point2d(kBorder, 30), cv::Point2d(right - kBorder, 30),
                                    cv::Point2d(40, kBorder), cv::Point2d(40, bottom - kBorder)}) {
    EXPECT_EQ(DetectHessian(Spot(kSize, inside, 60.0), kBorder, 0.5F).size(), 1U) << inside;
  }
  for (const cv::Point2d& outside : {cv::Point2d(kBorder - 1, 30), cv::Point2d(right - kBorder + 1, 30),
                                     cv::Point2d(40, kBorder - 1), cv::Point2d(40, bottom - kBorder + 1)}) {
    EXPECT_TRUE(DetectHessian(Spot(kSize, outside, 60.0), kBorder, 0.5F).empty()) << outside;
  }
}

TEST(HessianDetectorTest, FindsTheSameWithAWiderBorderWhereBothLook) {
  cv::Mat smooth;
  cv::GaussianBlur(testing_vision::MakeTexture({200, 160}, 128.0, 40.0, 1), smooth, {}, 2.5);
  smooth.convertTo(smooth, CV_32F);
  constexpr int kWide = 30;
  const auto wide = DetectHessian(smooth, kWide, 0.05F);
  std::vector<cv::KeyPoint> expected;
  for (const cv::KeyPoint& k : DetectHessian(smooth, 0, 0.05F)) {
    if (cvRound(k.pt.x) >= kWide && cvRound(k.pt.x) < 200 - kWide && cvRound(k.pt.y) >= kWide &&
        cvRound(k.pt.y) < 160 - kWide) {
      expected.push_back(k);
    }
  }
  ASSERT_GT(wide.size(), 20U);
  ASSERT_EQ(wide.size(), expected.size());
  for (std::size_t i = 0; i < wide.size(); ++i) {
    EXPECT_EQ(wide[i].pt, expected[i].pt);
    EXPECT_EQ(wide[i].response, expected[i].response);
  }
}

TEST(HessianDetectorTest, ImagesSmallerThanTheBordersHaveNoKeypoints) {
  EXPECT_TRUE(DetectHessian(cv::Mat(0, 0, CV_32F), kBorder, 0.0F).empty());
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(5, 5), cv::Size(20, 60), cv::Size(60, 20), cv::Size(60, 3)}) {
    const cv::Point2d middle(0.5 * size.width, 0.5 * size.height);
    EXPECT_TRUE(DetectHessian(Spot(size, middle, 60.0), kBorder, 0.5F).empty()) << size;
  }
  EXPECT_TRUE(DetectHessian(Spot({8, 8}, {4.0, 4.0}, 60.0), 0, 0.5F).empty());
  EXPECT_EQ(DetectHessian(Spot({21, 21}, {10.0, 10.0}, 60.0), kBorder, 0.5F).size(), 1U);
}

TEST(HessianDetectorTest, ASpotBetweenPixelsIsOneKeypoint) {
  cv::Mat smooth(60, 60, CV_32FC1);
  for (int v = 0; v < smooth.rows; ++v) {
    for (int u = 0; u < smooth.cols; ++u) {
      const float du = static_cast<float>(u) - 29.5F;
      const float dv = static_cast<float>(v) - 29.5F;
      smooth.at<float>(v, u) = 100.0F * std::exp(-(du * du + dv * dv) / 18.0F);
    }
  }
  const std::vector<cv::KeyPoint> found = DetectHessian(smooth, 10, 1.0F);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].pt.x, 29.5F, 0.1F);
  EXPECT_NEAR(found[0].pt.y, 29.5F, 0.1F);
}

}  // namespace
}  // namespace floorloc
