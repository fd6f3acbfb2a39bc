// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/keypoint_usefulness.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

// Points that a frame detects with probability equal to their response (0 to 1), plus one more observation each.
std::vector<PointHistory> MakePoints(int count, int frames) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<PointHistory> points;
  for (int i = 0; i < count; ++i) {
    const float response = unit(random);
    std::binomial_distribution<int> found(frames, response);
    points.push_back({1 + found(random), 1 + frames, response, 255});
  }
  return points;
}

TEST(KeypointUsefulnessTest, RatesAreLearnedByResponse) {
  const RepeatRates rates(MakePoints(20000, 3));
  for (const float response : {0.1F, 0.5F, 0.9F}) {
    EXPECT_NEAR(rates.OfResponse(response), response, 0.05);
  }
}

TEST(KeypointUsefulnessTest, ManyFramesOutweighThePriorFewDoNot) {
  const RepeatRates rates(MakePoints(20000, 3));
  EXPECT_NEAR(rates.Of({1, 1, 0.9F, 255}), 0.9, 0.05) << "its own view tells nothing";
  EXPECT_NEAR(rates.Of({21, 101, 0.9F, 255}), 0.2, 0.05);
  EXPECT_GT(rates.Of({2, 3, 0.9F, 255}), rates.Of({2, 3, 0.2F, 255}));
  EXPECT_GT(rates.Of({3, 3, 0.5F, 255}), rates.Of({1, 3, 0.5F, 255}));
  EXPECT_LE(rates.Of({9, 3, 0.5F, 255}), 1.0) << "more views than frames in whose view it was";
}

TEST(KeypointUsefulnessTest, NoPointsGiveNoRates) { EXPECT_NEAR(RepeatRates({}).OfResponse(3.0F), 0.5, 1e-9); }

TEST(KeypointUsefulnessTest, DuplicatesAreOfLittleUse) {
  const std::vector<double> usefulness =
      Usefulness({{3, 3, 1.0F, 200}, {3, 3, 1.0F, 50}, {1, 3, 1.0F, 200}}, RepeatRates({}));
  EXPECT_NEAR(usefulness[0], 4.0 * usefulness[1], 1e-9);
  EXPECT_GT(usefulness[0], usefulness[2]);
}

// Two cells of ten points: in the first seven have duplicates, in the second one has.
TEST(KeypointUsefulnessTest, WhereDuplicatesAreCommonTheyCountLikeTheOthers) {
  std::vector<Eigen::Vector2d> positions;
  std::vector<PointHistory> points;
  for (int i = 0; i < 20; ++i) {
    positions.emplace_back(i < 10 ? 0.05 : 0.15, 0.05);
    points.push_back({2, 3, 1.0F, static_cast<std::uint8_t>(i < 7 || i == 10 ? 20 : 150)});
  }
  IgnoreDuplicatesWhereCommon(positions, 0.1, &points);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(points[static_cast<std::size_t>(i)].distinctiveness, i < 10 ? 255 : (i == 10 ? 20 : 150));
  }
}

}  // namespace
}  // namespace floorloc
