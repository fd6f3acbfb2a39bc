// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/upright_image.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "core/geometry/pose2.h"
#include "core/vision/extractors/extractor_layout.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/extractors/steered_brief.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSidePx = 181;

GroundImage ImageOf(const cv::Mat& gray) {
  const double half_m = 0.5 * (kSidePx - 1) * 1e-3;
  return {{half_m, half_m, 1e-3, kSidePx, kSidePx}, gray, cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255))};
}

int BitsApart(const cv::Mat& a, const cv::Mat& b, int row) {
  int bits = 0;
  for (int i = 0; i < a.cols; ++i) {
    bits += std::popcount(static_cast<std::uint8_t>(a.at<std::uint8_t>(row, i) ^ b.at<std::uint8_t>(row, i)));
  }
  return bits;
}

class UprightImageTest : public ::testing::Test {
 protected:
  UprightImage Upright(const cv::Mat& gray) const {
    const GroundImage image = ImageOf(gray);
    return extractor_->MakeUpright(image.grid, extractor_->Prepare(image));
  }

  std::unique_ptr<FeatureExtractor> extractor_ = CreateFeatureExtractor(ExtractorOptions());
  cv::Mat floor_ = testing_vision::MakeTexture({kSidePx, kSidePx}, 120.0, 25.0, 4);
};

// The robot turns to the left by 90 degrees: what it sees turns to the right, exactly.
TEST_F(UprightImageTest, DescriptorsAtTheTrueHeadingDoNotDependOnIt) {
  cv::Mat seen_after_turning;
  cv::rotate(floor_, seen_after_turning, cv::ROTATE_90_CLOCKWISE);
  const UprightImage before = Upright(floor_);
  const UprightImage after = Upright(seen_after_turning);
  const GroundImage image = ImageOf(floor_);
  const std::vector<Keypoint> keypoints = extractor_->Extract(image).keypoints;
  ASSERT_GT(keypoints.size(), 20U);
  std::vector<Keypoint> turned = keypoints;
  for (Keypoint& k : turned) {
    const Eigen::Vector2d p = Pose2(0.0, 0.0, -0.5 * kPi) * k.Position();
    k.x_m = static_cast<float>(p.x());
    k.y_m = static_cast<float>(p.y());
  }
  const cv::Mat at_zero = DescribeUpright(before, keypoints, 0.3);
  const cv::Mat at_ninety = DescribeUpright(after, turned, 0.3 + 0.5 * kPi);
  const cv::Mat wrongly = DescribeUpright(after, turned, 0.3 - 0.5 * kPi);
  int apart = 0;
  int wrong = 0;
  for (int i = 0; i < at_zero.rows; ++i) {
    apart += BitsApart(at_zero, at_ninety, i);
    wrong += BitsApart(at_zero, wrongly, i);
  }
  EXPECT_LT(apart, 12 * at_zero.rows) << "rounding alone";
  EXPECT_GT(wrong, 60 * at_zero.rows) << "the other way round is another floor";
}

TEST_F(UprightImageTest, ExtractionAlreadyHasTheImage) {
  const GroundImage image = ImageOf(floor_);
  UprightImage extracted;
  extractor_->Extract(image, extractor_->Prepare(image), &extracted);
  EXPECT_EQ(cv::norm(extracted.smooth, Upright(floor_).smooth, cv::NORM_INF), 0.0);
}

TEST_F(UprightImageTest, PointsBeyondTheImageAreNotRead) {
  std::vector<Keypoint> keypoints(4);
  keypoints[0].x_m = 0.5F * kSidePx * 1e-3F;
  keypoints[1].y_m = -1.0F;
  keypoints[2].x_m = 1e6F;
  const cv::Mat rows = DescribeUpright(Upright(floor_), keypoints, 0.0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cv::countNonZero(rows.row(i)), 0) << i;
  }
  EXPECT_GT(cv::countNonZero(rows.row(3)), 0);
}

TEST(HasUprightTest, IsWhatTheExtractorsSay) {
  const GroundImage image = ImageOf(testing_vision::MakeTexture({kSidePx, kSidePx}, 120.0, 25.0, 4));
  for (const ExtractorType type : AllExtractorTypes()) {
    ExtractorOptions options;
    options.type = type;
    const auto extractor = CreateFeatureExtractor(options);
    EXPECT_EQ(extractor->MakeUpright(image.grid, extractor->Prepare(image)).empty(), !HasUpright(type))
        << ToString(type);
  }
}

}  // namespace
}  // namespace floorloc
