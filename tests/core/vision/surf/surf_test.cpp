// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "tests/core/vision/blob_images.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::AngleBetween;
using testing_vision::DrawBlobs;
using testing_vision::InThreads;
using testing_vision::MakeTexture;
using testing_vision::Same;
using testing_vision::TurnedRight;

class SurfTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SurfAvailable()) {
      GTEST_SKIP() << "built without SURF";
    }
  }

  // Odd sides, so that the second octave samples the same pixels when the image is rotated.
  const cv::Mat texture_ = MakeTexture({421, 401}, 110.0, 14.0, 1);
};

TEST_F(SurfTest, FindsBlobsToAFractionOfAPixel) {
  for (const cv::Point2d middle : {cv::Point2d(100.0, 80.0), cv::Point2d(100.3, 80.5), cv::Point2d(99.6, 79.8)}) {
    for (const double height : {80.0, -80.0}) {
      const std::vector<cv::KeyPoint> found = Surf({}).Detect(DrawBlobs({200, 160}, {{middle, 3.0, height}}));
      ASSERT_FALSE(found.empty());
      EXPECT_LT(cv::norm(cv::Point2d(found[0].pt) - middle), 0.1) << found[0].pt << " for " << middle;
      EXPECT_EQ(found[0].class_id, height < 0.0 ? 1 : -1);
    }
  }
}

// Box filters are slightly wider than the Gaussians of their scale, so the detected scale of a blob is smaller.
TEST_F(SurfTest, SizeFollowsTheBlob) {
  const auto size = [](double sigma_px) {
    return Surf({.octaves = 3, .layers = 4}).Detect(DrawBlobs({240, 240}, {{{120.0, 120.0}, sigma_px, 80.0}}))[0].size;
  };
  EXPECT_NEAR(size(3.0) * kSurfScalePerSize, 2.2F, 0.3F);
  EXPECT_NEAR(size(6.0) / size(3.0), 2.0F, 0.15F);
}

TEST_F(SurfTest, CoarseFirstStepFindsTheSamePlace) {
  const cv::Mat gray = DrawBlobs({200, 160}, {{{100.3, 80.6}, 3.5, 80.0}});
  const std::vector<cv::KeyPoint> found = Surf({.first_step_px = 2}).Detect(gray);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(cv::norm(cv::Point2d(found[0].pt) - cv::Point2d(100.3, 80.6)), 0.25);
}

TEST_F(SurfTest, TurnsWithTheImage) {
  cv::Mat turned;
  cv::rotate(texture_, turned, cv::ROTATE_90_CLOCKWISE);
  std::vector<cv::KeyPoint> before;
  std::vector<cv::KeyPoint> after;
  const Surf surf({});
  const cv::Mat before_rows = surf.DetectAndDescribe(texture_, cv::Mat(), &before);
  const cv::Mat after_rows = surf.DetectAndDescribe(turned, cv::Mat(), &after);
  ASSERT_GT(before.size(), 200U);
  std::size_t found = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const cv::Point2f expected = TurnedRight(texture_.size(), before[i].pt);
    for (std::size_t j = 0; j < after.size(); ++j) {
      if (cv::norm(after[j].pt - expected) < 0.01 && std::abs(after[j].size - before[i].size) < 0.01F) {
        EXPECT_LT(AngleBetween(after[j].angle, before[i].angle + 90.0F), 1.0F);
        EXPECT_LT(cv::norm(after_rows.row(static_cast<int>(j)), before_rows.row(static_cast<int>(i))), 0.05);
        ++found;
        break;
      }
    }
  }
  EXPECT_GT(static_cast<double>(found), 0.97 * static_cast<double>(before.size()));
}

// Angles are clockwise from the image's +x axis, as in OpenCV.
TEST_F(SurfTest, AnglePointsWhereBrightnessRises) {
  cv::Mat ramp(120, 120, CV_8UC1);
  for (int y = 0; y < ramp.rows; ++y) {
    ramp.row(y) = cv::Scalar(2 * y);
  }
  std::vector<cv::KeyPoint> keypoints{cv::KeyPoint(60.0F, 60.0F, 15.0F)};
  Surf({}).Describe(ramp, &keypoints);
  ASSERT_EQ(keypoints.size(), 1U);
  EXPECT_NEAR(keypoints[0].angle, 90.0F, 1.0F);
}

TEST_F(SurfTest, KeepsTheAngleThatIsGiven) {
  std::vector<cv::KeyPoint> keypoints{cv::KeyPoint(200.0F, 200.0F, 15.0F, 33.0F)};
  Surf({}).Describe(texture_, &keypoints);
  EXPECT_EQ(keypoints[0].angle, 33.0F);
  Surf({.upright = true}).Describe(texture_, &keypoints);
  EXPECT_EQ(keypoints[0].angle, 0.0F);
}

TEST_F(SurfTest, BrightnessAndContrastChangeLittle) {
  const Surf surf({});
  std::vector<cv::KeyPoint> keypoints = surf.Detect(texture_);
  const cv::Mat rows = surf.Describe(texture_, &keypoints);
  cv::Mat other;
  texture_.convertTo(other, CV_8U, 1.6, -50.0);
  const cv::Mat other_rows = surf.Describe(other, &keypoints);
  ASSERT_EQ(other_rows.rows, rows.rows);
  for (int i = 0; i < rows.rows; ++i) {
    EXPECT_NEAR(cv::norm(rows.row(i)), 1.0, 1e-5);
    EXPECT_LT(cv::norm(rows.row(i), other_rows.row(i)), 0.1);
  }
}

TEST_F(SurfTest, DescriptorsDistinguishPlaces) {
  std::vector<cv::KeyPoint> keypoints = Surf({}).Detect(texture_);
  const cv::Mat rows = Surf({}).Describe(texture_, &keypoints);
  int similar = 0;
  for (int i = 1; i < rows.rows; ++i) {
    similar += cv::norm(rows.row(i), rows.row(0)) < 0.2 ? 1 : 0;
  }
  EXPECT_LE(similar, 2);
}

TEST_F(SurfTest, MaskAndCountLimitWhatIsFound) {
  cv::Mat mask(texture_.size(), CV_8UC1, cv::Scalar(255));
  mask.colRange(0, 200) = 0;
  const std::vector<cv::KeyPoint> found = Surf({.max_keypoints = 50}).Detect(texture_, mask);
  ASSERT_EQ(found.size(), 50U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GE(found[i].pt.x, 199.5F);
    EXPECT_GE(found[0].response, found[i].response);
  }
}

TEST_F(SurfTest, DropsWhatItCannotDescribe) {
  std::vector<cv::KeyPoint> keypoints{cv::KeyPoint(5.0F, 200.0F, 15.0F), cv::KeyPoint(200.0F, 200.0F, 15.0F)};
  const cv::Mat rows = Surf({}).Describe(texture_, &keypoints);
  EXPECT_EQ(rows.rows, 1);
  ASSERT_EQ(keypoints.size(), 1U);
  EXPECT_EQ(keypoints[0].pt.x, 200.0F);
}

TEST_F(SurfTest, ToleratesEmptyTinyAndBlankImages) {
  const Surf surf({.threshold = 0.0, .octaves = 8, .layers = 8});
  std::vector<cv::KeyPoint> keypoints;
  EXPECT_TRUE(surf.DetectAndDescribe(cv::Mat(), cv::Mat(), &keypoints).empty());
  for (int side = 1; side < 60; ++side) {
    EXPECT_NO_THROW(surf.Detect(MakeTexture({side, side + 2}, 110.0, 14.0, 3))) << side;
  }
  EXPECT_TRUE(surf.Detect(cv::Mat(100, 100, CV_8UC1, cv::Scalar(77))).empty());
  EXPECT_THROW(surf.Detect(cv::Mat(100, 100, CV_8UC3)), std::invalid_argument);
}

TEST_F(SurfTest, EveryThreadFindsTheSame) {
  const Surf surf({});
  std::vector<cv::KeyPoint> keypoints;
  const cv::Mat alone = surf.DetectAndDescribe(texture_, cv::Mat(), &keypoints);
  std::vector<cv::Mat> together(4);
  InThreads(4, [&](std::size_t i) {
    std::vector<cv::KeyPoint> found;
    together[i] = surf.DetectAndDescribe(texture_, cv::Mat(), &found);
  });
  for (const cv::Mat& rows : together) {
    EXPECT_TRUE(Same(rows, alone));
  }
}

TEST_F(SurfTest, RefusesNonsense) {
  EXPECT_THROW(Surf({.threshold = -1.0}), std::invalid_argument);
  EXPECT_THROW(Surf({.threshold = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(Surf({.octaves = 0}), std::invalid_argument);
  EXPECT_THROW(Surf({.layers = 9}), std::invalid_argument);
  EXPECT_THROW(Surf({.first_step_px = 3}), std::invalid_argument);
  EXPECT_THROW(Surf({.max_keypoints = -1}), std::invalid_argument);
}

TEST(WithoutSurf, SaysSo) {
  if (SurfAvailable()) {
    GTEST_SKIP() << "built with SURF";
  }
  EXPECT_THROW(Surf({}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
