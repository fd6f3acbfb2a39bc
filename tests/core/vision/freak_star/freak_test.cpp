// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/freak.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>
#include <stdexcept>

#include "core/vision/freak_star/freak_pairs.h"
#include "core/vision/freak_star/freak_pattern.h"
#include "core/vision/freak_star/star.h"
#include "tests/core/vision/blob_images.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::AngleBetween;
using testing_vision::MakeTexture;
using testing_vision::TurnedRight;

class FreakTest : public ::testing::Test {
 protected:
  double BitsApart(const cv::Mat& a, const cv::Mat& b, std::size_t i) const {
    return cv::norm(a.row(static_cast<int>(i)), b.row(static_cast<int>(i)), cv::NORM_HAMMING);
  }

  const cv::Mat texture_ = MakeTexture({420, 400}, 110.0, 14.0, 1);
  const std::vector<cv::KeyPoint> keypoints_ = Star({.threshold = 4.0, .max_keypoints = 200}).Detect(texture_);
};

TEST_F(FreakTest, PairsAreDifferentComparisonsOfFields) {
  std::set<std::pair<int, int>> pairs;
  for (const FreakPair& pair : kFreakPairs) {
    EXPECT_LT(pair.brighter, pair.darker);
    EXPECT_LT(pair.darker, kFreakFields);
    pairs.insert({pair.brighter, pair.darker});
  }
  EXPECT_EQ(pairs.size(), kFreakPairs.size());
}

TEST_F(FreakTest, TurnsWithTheImage) {
  cv::Mat turned;
  cv::rotate(texture_, turned, cv::ROTATE_90_CLOCKWISE);
  std::vector<cv::KeyPoint> before = keypoints_;
  std::vector<cv::KeyPoint> after = keypoints_;
  for (cv::KeyPoint& k : after) {
    k.pt = TurnedRight(texture_.size(), k.pt);
  }
  const cv::Mat before_rows = Freak({}).Describe(texture_, &before);
  const cv::Mat after_rows = Freak({}).Describe(turned, &after);
  ASSERT_GT(before.size(), 100U);
  ASSERT_EQ(after.size(), before.size());
  double angles_deg = 0.0;
  double bits = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    angles_deg += AngleBetween(after[i].angle, before[i].angle + 90.0F);
    bits += BitsApart(after_rows, before_rows, i);
  }
  // A ring of six fields is not invariant to a rotation by 90 degrees, so the result is only approximate.
  EXPECT_LT(angles_deg / static_cast<double>(before.size()), 12.0);
  EXPECT_LT(bits / static_cast<double>(before.size()), 60.0);
}

TEST_F(FreakTest, AnglePointsWhereBrightnessRises) {
  cv::Mat ramp(120, 120, CV_8UC1);
  for (int y = 0; y < ramp.rows; ++y) {
    ramp.row(y) = cv::Scalar(2 * y);
  }
  std::vector<cv::KeyPoint> keypoints{cv::KeyPoint(60.0F, 60.0F, 12.0F)};
  Freak({}).Describe(ramp, &keypoints);
  ASSERT_EQ(keypoints.size(), 1U);
  EXPECT_NEAR(keypoints[0].angle, 90.0F, 1.0F);
}

TEST_F(FreakTest, BrightnessAndContrastChangeLittle) {
  std::vector<cv::KeyPoint> keypoints = keypoints_;
  const cv::Mat rows = Freak({}).Describe(texture_, &keypoints);
  EXPECT_EQ(rows.cols, kFreakBytes);
  cv::Mat other;
  texture_.convertTo(other, CV_8U, 1.6, -50.0);
  const cv::Mat other_rows = Freak({}).Describe(other, &keypoints);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    EXPECT_LT(BitsApart(rows, other_rows, i), 30.0);
  }
}

TEST_F(FreakTest, DescriptorsDistinguishPlaces) {
  std::vector<cv::KeyPoint> keypoints = keypoints_;
  const cv::Mat rows = Freak({}).Describe(texture_, &keypoints);
  double bits = 0.0;
  for (int i = 1; i < rows.rows; ++i) {
    bits += cv::norm(rows.row(i), rows.row(i - 1), cv::NORM_HAMMING) / (rows.rows - 1);
  }
  EXPECT_GT(bits, 150.0);
}

TEST_F(FreakTest, UnscaledAndUprightDoAsToldToEveryKeypoint) {
  std::vector<cv::KeyPoint> small{cv::KeyPoint(200.0F, 200.0F, 9.0F)};
  std::vector<cv::KeyPoint> large{cv::KeyPoint(200.0F, 200.0F, 20.0F)};
  const Freak plain({.oriented = false, .scaled = false});
  EXPECT_EQ(cv::norm(plain.Describe(texture_, &small), plain.Describe(texture_, &large), cv::NORM_HAMMING), 0.0);
  EXPECT_EQ(small[0].angle, 0.0F);
  EXPECT_GT(cv::norm(Freak({}).Describe(texture_, &small), Freak({}).Describe(texture_, &large), cv::NORM_HAMMING),
            20.0);
}

TEST_F(FreakTest, DropsWhatItCannotDescribe) {
  std::vector<cv::KeyPoint> keypoints{cv::KeyPoint(5.0F, 200.0F, 9.0F), cv::KeyPoint(200.0F, 200.0F, 9.0F)};
  EXPECT_EQ(Freak({}).Describe(texture_, &keypoints).rows, 1);
  EXPECT_EQ(keypoints.size(), 1U);
  EXPECT_TRUE(Freak({}).Describe(cv::Mat(), &keypoints).empty());
  EXPECT_TRUE(keypoints.empty());
}

TEST_F(FreakTest, RefusesNonsense) {
  EXPECT_THROW(Freak({.reach_per_size = 0.0}), std::invalid_argument);
  EXPECT_THROW(Freak({.reach_per_size = std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
