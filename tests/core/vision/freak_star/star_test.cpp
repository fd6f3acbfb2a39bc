// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/star.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/vision/freak_star/star_response.h"
#include "tests/core/vision/blob_images.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::DrawBlobs;
using testing_vision::MakeTexture;
using testing_vision::TurnedRight;

double SlowSum(const cv::Mat& gray, const StarShape& star, int x, int y) {
  double sum = 0.0;
  const int reach = std::max(star.square, star.tip);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const int times = (std::max(std::abs(dx), std::abs(dy)) <= star.square ? 1 : 0) +
                        (std::abs(dx) + std::abs(dy) <= star.tip ? 1 : 0);
      sum += times == 0 ? 0.0 : times * gray.at<std::uint8_t>(y + dy, x + dx);
    }
  }
  return sum;
}

TEST(StarResponseTest, IsWhatAddingPixelsGives) {
  const cv::Mat gray = MakeTexture({61, 53}, 120.0, 30.0, 4);
  for (const StarScale& scale : StarScales(47)) {
    const cv::Mat response = StarResponse(IntegralImage(gray), TriangleSums(gray), scale);
    const int margin = scale.outer.tip;
    for (int y = margin; y < gray.rows - margin; ++y) {
      for (int x = margin; x < gray.cols - margin; ++x) {
        const double inner = SlowSum(gray, scale.inner, x, y);
        const double ring = SlowSum(gray, scale.outer, x, y) - inner;
        const double expected = ring / (scale.outer.area() - scale.inner.area()) - inner / scale.inner.area();
        ASSERT_NEAR(response.at<float>(y, x), expected, 1e-3) << x << " " << y << " size " << scale.size_px();
      }
    }
  }
}

TEST(StarTest, FindsBlobsToAFractionOfAPixel) {
  for (const cv::Point2d middle : {cv::Point2d(100.0, 80.0), cv::Point2d(100.3, 80.5), cv::Point2d(99.6, 79.8)}) {
    for (const double height : {80.0, -80.0}) {
      const std::vector<cv::KeyPoint> found = Star({}).Detect(DrawBlobs({200, 160}, {{middle, 3.0, height}}));
      ASSERT_EQ(found.size(), 1U);
      EXPECT_LT(cv::norm(cv::Point2d(found[0].pt) - middle), 0.15) << found[0].pt << " for " << middle;
      EXPECT_EQ(found[0].class_id, height < 0.0 ? 1 : -1);
    }
  }
}

TEST(StarTest, SizeFollowsTheBlob) {
  const auto size = [](double sigma_px) {
    return Star({.max_size_px = 91}).Detect(DrawBlobs({240, 240}, {{{120.0, 120.0}, sigma_px, 80.0}}))[0].size;
  };
  EXPECT_NEAR(size(6.0) / size(3.0), 2.0F, 0.3F);
}

TEST(StarTest, PassesOverLines) {
  cv::Mat gray(160, 200, CV_8UC1, cv::Scalar(128));
  gray.colRange(98, 102) = 220;
  EXPECT_TRUE(Star({}).Detect(gray).empty());
}

TEST(StarTest, TurnsWithTheImage) {
  const cv::Mat gray = MakeTexture({420, 400}, 110.0, 14.0, 1);
  cv::Mat turned;
  cv::rotate(gray, turned, cv::ROTATE_90_CLOCKWISE);
  const Star star({.threshold = 4.0});
  const std::vector<cv::KeyPoint> before = star.Detect(gray);
  const std::vector<cv::KeyPoint> after = star.Detect(turned);
  ASSERT_GT(before.size(), 200U);
  const auto found = std::count_if(before.begin(), before.end(), [&](const cv::KeyPoint& k) {
    const cv::Point2f expected = TurnedRight(gray.size(), k.pt);
    return std::any_of(after.begin(), after.end(),
                       [&](const cv::KeyPoint& other) { return cv::norm(other.pt - expected) < 0.02; });
  });
  EXPECT_GT(static_cast<double>(found), 0.97 * static_cast<double>(before.size()));
}

TEST(StarTest, MaskAndCountLimitWhatIsFound) {
  const cv::Mat gray = MakeTexture({420, 400}, 110.0, 14.0, 1);
  cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(255));
  mask.colRange(0, 200) = 0;
  const std::vector<cv::KeyPoint> found = Star({.threshold = 2.0, .max_keypoints = 50}).Detect(gray, mask);
  ASSERT_EQ(found.size(), 50U);
  for (const cv::KeyPoint& k : found) {
    EXPECT_GE(k.pt.x, 199.5F);
  }
}

TEST(StarTest, ToleratesEmptyTinyAndBlankImages) {
  EXPECT_TRUE(Star({}).Detect(cv::Mat()).empty());
  for (int side = 1; side < 60; ++side) {
    EXPECT_NO_THROW(Star({.threshold = 0.0}).Detect(MakeTexture({side, side + 2}, 110.0, 14.0, 3))) << side;
  }
  EXPECT_TRUE(Star({.threshold = 0.0}).Detect(cv::Mat(100, 100, CV_8UC1, cv::Scalar(77))).empty());
}

TEST(StarTest, RefusesNonsense) {
  EXPECT_THROW(Star({.threshold = -1.0}), std::invalid_argument);
  EXPECT_THROW(Star({.max_size_px = 9}), std::invalid_argument);
  EXPECT_THROW(Star({.line_ratio = 0.5}), std::invalid_argument);
  EXPECT_THROW(Star({.max_keypoints = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
