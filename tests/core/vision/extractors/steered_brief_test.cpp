// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/steered_brief.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "core/vision/features/keypoint_angle.h"
#include "core/vision/image/gaussian.h"
#include "tests/core/vision/blob_images.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
const cv::Size kSize(161, 121);

cv::KeyPoint KeypointAt(float u, float v, float angle_deg) { return {u, v, 0.0F, angle_deg}; }

// A grid of keypoints over the image whose angles differ.
std::vector<cv::KeyPoint> SomeKeypoints() {
  std::vector<cv::KeyPoint> keypoints;
  for (int v = 20; v < kSize.height - 20; v += 16) {
    for (int u = 20; u < kSize.width - 20; u += 16) {
      const auto angle_deg = static_cast<float>(keypoints.size()) * 23.7F;
      keypoints.push_back(KeypointAt(static_cast<float>(u), static_cast<float>(v), std::fmod(angle_deg, 360.0F)));
    }
  }
  return keypoints;
}

cv::Mat Levels(const cv::Mat& gray, double gain = 1.0, double bias = 0.0) {
  cv::Mat levels;
  SmoothGaussian(gray, 2.5).convertTo(levels, CV_16S, 64.0);
  return levels * gain + bias;
}

// Share of the bits that differ.
double Difference(const cv::Mat& a, const cv::Mat& b) {
  int bits = 0;
  for (int row = 0; row < a.rows; ++row) {
    for (int i = 0; i < a.cols; ++i) {
      bits += std::popcount(static_cast<std::uint8_t>(a.at<std::uint8_t>(row, i) ^ b.at<std::uint8_t>(row, i)));
    }
  }
  return bits / (8.0 * static_cast<double>(a.total()));
}

TEST(OrientByCentroidTest, PointsUpTheSlope) {
  for (int degrees = 0; degrees < 360; degrees += 15) {
    cv::Mat slope(kSize, CV_8UC1);
    for (int v = 0; v < slope.rows; ++v) {
      for (int u = 0; u < slope.cols; ++u) {
        const double along = (u - 80) * std::cos(degrees * kPi / 180.0) + (v - 60) * std::sin(degrees * kPi / 180.0);
        slope.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(128.0 + 4.0 * along);
      }
    }
    std::vector<cv::KeyPoint> keypoints{KeypointAt(80.3F, 59.8F, -1.0F)};
    OrientByCentroid(slope, &keypoints);
    EXPECT_LT(testing_vision::AngleBetween(keypoints[0].angle, static_cast<float>(degrees)), 1.0F) << degrees;
    EXPECT_GE(keypoints[0].angle, 0.0F);
    EXPECT_LE(keypoints[0].angle, 360.0F);
  }
}

TEST(OrientByCentroidTest, LooksAtADiscOnly) {
  cv::Mat image(kSize, CV_8UC1, cv::Scalar(100));
  image.at<std::uint8_t>(60, 95) = 200;            // to the right, at the border of the disc
  image.at<std::uint8_t>(60 + 12, 80 + 12) = 250;  // in the square around the disc, outside the disc
  image.at<std::uint8_t>(60, 80 - 16) = 250;
  std::vector<cv::KeyPoint> keypoints{KeypointAt(80.0F, 60.0F, -1.0F)};
  OrientByCentroid(image, &keypoints);
  EXPECT_EQ(keypoints[0].angle, 0.0F);
}

TEST(OrientByCentroidTest, WorksAsNearToTheEdgeAsItSays) {
  const cv::Mat gray = testing_vision::MakeTexture(kSize, 128.0, 40.0, 5);
  const auto far_u = static_cast<float>(kSize.width - 1 - kBriefReachPx);
  const auto far_v = static_cast<float>(kSize.height - 1 - kBriefReachPx);
  const std::vector<cv::KeyPoint> corners{KeypointAt(kBriefReachPx, kBriefReachPx, 45.0F),
                                          KeypointAt(far_u, kBriefReachPx, 45.0F),
                                          KeypointAt(kBriefReachPx, far_v, 45.0F), KeypointAt(far_u, far_v, 45.0F)};
  cv::Mat padded;  // pixels beyond the image must have no influence
  cv::copyMakeBorder(gray, padded, 40, 40, 40, 40, cv::BORDER_CONSTANT, cv::Scalar(255));
  std::vector<cv::KeyPoint> here = corners;
  std::vector<cv::KeyPoint> there = corners;
  for (cv::KeyPoint& k : there) {
    k.pt += cv::Point2f(40.0F, 40.0F);
  }
  OrientByCentroid(gray, &here);
  OrientByCentroid(padded, &there);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_EQ(here[i].angle, there[i].angle);
  }
  cv::Mat levels, padded_levels;
  gray.convertTo(levels, CV_16S);
  padded.convertTo(padded_levels, CV_16S);
  EXPECT_TRUE(testing_vision::Same(DescribeBrief(levels, here), DescribeBrief(padded_levels, there)));
}

TEST(DescribeBriefTest, BrightnessDoesNotMatter) {
  const cv::Mat gray = testing_vision::MakeTexture(kSize, 90.0, 20.0, 1);
  const std::vector<cv::KeyPoint> keypoints = SomeKeypoints();
  const cv::Mat descriptors = DescribeBrief(Levels(gray), keypoints);
  ASSERT_EQ(descriptors.rows, static_cast<int>(keypoints.size()));
  ASSERT_EQ(descriptors.cols, kBriefBytes);
  EXPECT_TRUE(testing_vision::Same(descriptors, DescribeBrief(Levels(gray, 2.0, -3000.0), keypoints)));
}

TEST(DescribeBriefTest, TurnsWithTheKeypoint) {
  const cv::Mat gray = testing_vision::MakeTexture(kSize, 128.0, 40.0, 2);
  cv::Mat turned;
  cv::rotate(gray, turned, cv::ROTATE_90_CLOCKWISE);
  const std::vector<cv::KeyPoint> keypoints = SomeKeypoints();
  std::vector<cv::KeyPoint> moved = keypoints;
  for (cv::KeyPoint& k : moved) {
    k.pt = testing_vision::TurnedRight(kSize, k.pt);
    k.angle = std::fmod(k.angle + 90.0F, 360.0F);
  }
  const cv::Mat descriptors = DescribeBrief(Levels(gray), keypoints);
  EXPECT_LT(Difference(descriptors, DescribeBrief(Levels(turned), moved)), 0.005);
  for (cv::KeyPoint& k : moved) {
    k.angle = std::fmod(k.angle + 180.0F, 360.0F);
  }
  EXPECT_GT(Difference(descriptors, DescribeBrief(Levels(turned), moved)), 0.3);
}

TEST(DescribeBriefTest, PlacesDiffer) {
  const cv::Mat gray = testing_vision::MakeTexture(kSize, 128.0, 40.0, 3);
  const std::vector<cv::KeyPoint> keypoints = SomeKeypoints();
  const cv::Mat descriptors = DescribeBrief(Levels(gray), keypoints);
  const cv::Mat next = descriptors.rowRange(1, descriptors.rows);
  EXPECT_NEAR(Difference(descriptors.rowRange(0, descriptors.rows - 1), next), 0.5, 0.1);
  EXPECT_EQ(DescribeBrief(Levels(gray), {}).rows, 0);
}

TEST(BaseAngleTest, ForwardIsUpAndLeftIsLeft) {
  EXPECT_NEAR(BaseAngle(0.0F), -0.5 * kPi, 1e-6);
  EXPECT_NEAR(std::abs(BaseAngle(90.0F)), kPi, 1e-6);
  EXPECT_NEAR(BaseAngle(180.0F), 0.5 * kPi, 1e-6);
  EXPECT_NEAR(BaseAngle(270.0F), 0.0, 1e-6);
  EXPECT_NEAR(BaseAngle(300.0F), -30.0 * kPi / 180.0, 1e-6);
}

}  // namespace
}  // namespace floorloc
