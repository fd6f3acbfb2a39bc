// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/fuse_track.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace floorloc {
namespace {

TEST(FuseTrackTest, OneOutlierHardlyMovesTheMean) {
  std::vector<WeightedPosition> positions;
  for (int i = 0; i < 8; ++i) {
    positions.push_back({{1.0 + (i % 2 == 0 ? 1e-4 : -1e-4), 2.0}, 1.0});
  }
  positions.push_back({{1.0, 2.009}, 1.0});
  const Eigen::Vector2d mean = RobustMean(positions, 3e-4);
  EXPECT_NEAR(mean.x(), 1.0, 1e-5);
  EXPECT_NEAR(mean.y(), 2.0, 1e-4);  // the arithmetic mean has an error of 1 mm
}

TEST(FuseTrackTest, WeightsCount) {
  EXPECT_NEAR(RobustMean({{{0.0, 0.0}, 3.0}, {{4e-4, 0.0}, 1.0}}, 3e-4).x(), 1e-4, 1e-9);
}

// Reference implementation of the definition, bit by bit.
TEST(DescriptorVoteTest, EveryBitIsDecidedByTheMajority) {
  for (const int views : {1, 2, 3, 4, 7, 30}) {
    cv::Mat descriptors(views, 61, CV_8U);
    cv::RNG(static_cast<std::uint64_t>(views)).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
    DescriptorVote vote(descriptors);
    cv::Mat fused(2, 61, CV_8U);
    for (const int row : {0, 1}) {  // it is reusable
      for (int i = 0; i < views; ++i) {
        vote.Add(descriptors, i);
      }
      vote.Finish(&fused, row);
    }
    for (int bit = 0; bit < 61 * 8; ++bit) {
      const auto has = [&](const cv::Mat& m, int row) { return m.at<std::uint8_t>(row, bit / 8) >> (bit % 8) & 1; };
      int ones = 0;
      for (int i = 0; i < views; ++i) {
        ones += has(descriptors, i);
      }
      const int majority = 2 * ones == views ? has(descriptors, 0) : (2 * ones > views ? 1 : 0);
      EXPECT_EQ(has(fused, 0), majority);
      EXPECT_EQ(has(fused, 1), majority);
    }
  }
}

TEST(DescriptorVoteTest, FloatsAreAveragedByVotes) {
  const cv::Mat descriptors = (cv::Mat_<float>(2, 2) << 1.0F, 2.0F, 5.0F, -2.0F);
  DescriptorVote vote(descriptors);
  vote.Add(descriptors, 0, 3);
  vote.Add(descriptors, 1);
  cv::Mat fused(1, 2, CV_32F);
  vote.Finish(&fused, 0);
  EXPECT_FLOAT_EQ(fused.at<float>(0, 0), 2.0F);
  EXPECT_FLOAT_EQ(fused.at<float>(0, 1), 1.0F);
}

}  // namespace
}  // namespace floorloc
