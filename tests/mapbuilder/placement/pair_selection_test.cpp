// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pair_selection.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <set>

namespace floorloc {
namespace {

using IndexPairs = std::set<std::pair<int, int>>;

struct MapFramesAndLinks {
  std::vector<std::optional<Pose2>> map_from_base;
  std::vector<RectM> floor_in_base;
};

// Frames of two cameras in a hall of 6 x 4 m around the origin; every tenth has no pose.
MapFramesAndLinks RandomFrames(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  MapFramesAndLinks frames;
  for (int i = 0; i < count; ++i) {
    frames.floor_in_base.push_back(i % 3 == 0 ? RectM{0.1, 0.5, -0.3, 0.3} : RectM{0.05, 0.35, -0.2, 0.2});
    frames.map_from_base.emplace_back(Pose2(3.0 * unit(random), 2.0 * unit(random), std::numbers::pi * unit(random)));
    if (i % 10 == 7) {
      frames.map_from_base.back().reset();
    }
  }
  return frames;
}

IndexPairs BruteForcePairs(const MapFramesAndLinks& frames, const NearbyOptions& options) {
  IndexPairs pairs;
  for (std::size_t second = 0; second < frames.map_from_base.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      const auto& a = frames.map_from_base[first];
      const auto& b = frames.map_from_base[second];
      if (a && b && static_cast<int>(second) >= options.first_new &&
          OverlapShare(frames.floor_in_base[first], frames.floor_in_base[second], a->Between(*b)) >=
              options.min_overlap) {
        pairs.emplace(static_cast<int>(first), static_cast<int>(second));
      }
    }
  }
  return pairs;
}

TEST(PairSelectionTest, NearbyPairsAreExactlyTheOverlappingOnes) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const MapFramesAndLinks frames = RandomFrames(400, seed);
    for (const auto& [min_overlap, first_new] : {std::pair{0.25, 0}, std::pair{0.02, 0}, std::pair{0.25, 300}}) {
      NearbyOptions options;
      options.min_overlap = min_overlap;
      options.first_new = first_new;
      IndexPairs found;
      for (const FramePair& pair : SelectNearbyPairs(frames.map_from_base, frames.floor_in_base, options)) {
        EXPECT_TRUE(found.emplace(pair.first, pair.second).second) << "a pair twice";
        ASSERT_TRUE(pair.first_from_second);
        const Pose2 expected = frames.map_from_base[static_cast<std::size_t>(pair.first)]->Between(
            *frames.map_from_base[static_cast<std::size_t>(pair.second)]);
        EXPECT_LT((pair.first_from_second->translation() - expected.translation()).norm(), 1e-12);
        EXPECT_EQ(pair.radius_m, options.radius_m);
      }
      const IndexPairs expected = BruteForcePairs(frames, options);
      EXPECT_EQ(found, expected);
      EXPECT_GT(expected.size(), 100U);
    }
  }
}

TEST(PairSelectionTest, OverlapIsAShareOfTheSecond) {
  const RectM square{0.0, 1.0, 0.0, 1.0};
  EXPECT_EQ(OverlapShare(square, square, Pose2()), 1.0);
  EXPECT_EQ(OverlapShare(square, square, Pose2(0.5, 0.0, 0.0)), 0.5);
  EXPECT_EQ(OverlapShare(square, square, Pose2(2.0, 0.0, 0.0)), 0.0);
  EXPECT_EQ(OverlapShare(square, {0.25, 0.5, 0.25, 0.5}, Pose2()), 1.0);
  EXPECT_EQ(OverlapShare(square, square, Pose2(1.0, 1.0, std::numbers::pi)), 1.0);
}

TEST(PairSelectionTest, ConsecutivePairsStayWithinASurvey) {
  std::vector<BuildFrame> frames(5);
  frames[2].survey = frames[3].survey = frames[4].survey = 1;
  frames[0].odom_from_base = Pose2(1.0, 0.0, 0.0);
  frames[1].odom_from_base = Pose2(1.0, 0.5, 0.5 * std::numbers::pi);
  frames[3].odom_from_base = Pose2();
  const std::vector<FramePair> pairs = SelectConsecutivePairs(frames);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(std::pair(pairs[0].first, pairs[0].second), std::pair(0, 1));
  EXPECT_EQ(std::pair(pairs[1].first, pairs[1].second), std::pair(2, 3));
  EXPECT_EQ(std::pair(pairs[2].first, pairs[2].second), std::pair(3, 4));
  ASSERT_TRUE(pairs[0].first_from_second);
  EXPECT_NEAR(pairs[0].first_from_second->y(), 0.5, 1e-12);
  EXPECT_NEAR(pairs[0].first_from_second->yaw(), 0.5 * std::numbers::pi, 1e-12);
  EXPECT_FALSE(pairs[1].first_from_second);
}

TEST(PairSelectionTest, FramesWithoutTextureHaveNoPairs) { EXPECT_TRUE(SelectNearbyPairs({}, {}, {}).empty()); }

}  // namespace
}  // namespace floorloc
