// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/guided_matcher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

constexpr double kCellM = 0.05;
constexpr double kPi = std::numbers::pi;

// A map of 3 x 2 m around the origin.
Features RandomMap(int count, bool binary, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  Features map;
  for (int i = 0; i < count; ++i) {
    const float x = 3.0F * unit(random) - 1.5F;
    const float y = 2.0F * unit(random) - 1.0F;
    const auto angle = static_cast<float>(2.0 * kPi * unit(random) - kPi);
    map.keypoints.push_back({x, y, angle, 0.02F + 0.02F * unit(random), unit(random)});
  }
  map.descriptors =
      binary ? testing_vision::RandomBits(count, 32, seed) : testing_vision::RandomFloats(count, 32, seed);
  return map;
}

// The map's keypoints within 0.3 m of the pose, in the base frame.
Features FeaturesSeenFrom(const Features& map, const Pose2& map_from_base) {
  Features seen;
  const Pose2 base_from_map = map_from_base.Inverse();
  for (std::size_t i = 0; i < map.keypoints.size(); ++i) {
    Keypoint k = map.keypoints[i];
    const Eigen::Vector2d p = base_from_map * k.Position();
    if (p.norm() < 0.3) {
      k.x_m = static_cast<float>(p.x());
      k.y_m = static_cast<float>(p.y());
      k.angle_rad = static_cast<float>(WrapAngle(k.angle_rad + base_from_map.yaw()));
      seen.keypoints.push_back(k);
      seen.descriptors.push_back(map.descriptors.row(static_cast<int>(i)));
    }
  }
  return seen;
}

bool IsCandidate(const Keypoint& query, const Keypoint& target, const MatchGuide& guide) {
  const double away = (guide.target_from_query * query.Position() - target.Position()).norm();
  const double turned = std::abs(WrapAngle(guide.target_from_query.yaw() + query.angle_rad - target.angle_rad));
  return away <= guide.radius_m && turned <= guide.yaw_radius_rad && query.size_m < kMaxSizeRatio * target.size_m &&
         target.size_m < kMaxSizeRatio * query.size_m;
}

class GuidedMatcherTest : public ::testing::TestWithParam<bool> {
 protected:
  Features map_ = RandomMap(4000, GetParam(), 1);
};

TEST_P(GuidedMatcherTest, FindsTheNearestOfTheCandidatesAndNoOther) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  const int norm = GetParam() ? cv::NORM_HAMMING : cv::NORM_L2;
  for (int trial = 0; trial < 10; ++trial) {
    const Features query = FeaturesSeenFrom(map_, Pose2(unit(random), unit(random), kPi * unit(random)));
    const MatchGuide guide{Pose2(unit(random), unit(random), kPi * unit(random)), 0.12, 0.5};
    std::size_t next = 0;
    const std::vector<Match> matches = matcher.FindNearest(query, guide);
    for (std::size_t q = 0; q < query.keypoints.size(); ++q) {
      double best = std::numeric_limits<double>::infinity();
      double second = best;
      for (std::size_t t = 0; t < map_.keypoints.size(); ++t) {
        if (IsCandidate(query.keypoints[q], map_.keypoints[t], guide)) {
          const double d =
              cv::norm(query.descriptors.row(static_cast<int>(q)), map_.descriptors.row(static_cast<int>(t)), norm);
          second = std::min(second, std::max(best, d));
          best = std::min(best, d);
        }
      }
      if (std::isinf(best)) {
        continue;
      }
      ASSERT_LT(next, matches.size());
      const Match& match = matches[next++];
      ASSERT_EQ(match.query, static_cast<int>(q));
      EXPECT_TRUE(IsCandidate(query.keypoints[q], map_.keypoints[static_cast<std::size_t>(match.train)], guide));
      EXPECT_NEAR(match.distance, best, 1e-3 * best + 1e-3);
      if (std::isfinite(second)) {
        EXPECT_NEAR(match.second_distance, second, 1e-3 * second);
      }
    }
    EXPECT_EQ(next, matches.size());
  }
}

TEST_P(GuidedMatcherTest, FindsItselfWithAGoodPrior) {
  const Pose2 pose(0.4, -0.2, 2.9);
  const Features query = FeaturesSeenFrom(map_, pose);
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  const std::vector<Match> matches = matcher.FindNearest(query, {pose * Pose2(0.01, -0.01, 0.02), 0.05, 0.1});
  ASSERT_EQ(matches.size(), query.keypoints.size());
  for (const Match& match : matches) {
    EXPECT_EQ(match.distance, 0.0F);
  }
}

TEST_P(GuidedMatcherTest, UprightDescriptorsMatchAtAnyAngle) {
  const Pose2 pose(0.4, -0.2, 2.9);
  Features map = map_;
  const cv::Mat upright = testing_vision::RandomBits(static_cast<int>(map.keypoints.size()), 32, 7);
  const GuidedMatcher matcher(map.keypoints, map.descriptors, kCellM, upright);
  map.descriptors = upright;
  Features query = FeaturesSeenFrom(map, pose);
  for (Keypoint& k : query.keypoints) {
    k.angle_rad += 2.0F;
  }
  MatchGuide guide{pose, 0.01, 0.1};
  guide.upright = true;
  const std::vector<Match> matches = matcher.FindNearest(query, guide);
  ASSERT_EQ(matches.size(), query.keypoints.size());
  for (const Match& match : matches) {
    EXPECT_EQ(match.distance, 0.0F);
  }
}

TEST_P(GuidedMatcherTest, UprightDescriptorsAreCheckedLikeTheOthers) {
  EXPECT_THROW(GuidedMatcher(map_.keypoints, map_.descriptors, kCellM, testing_vision::RandomBits(3, 32, 7)),
               std::invalid_argument);
  const cv::Mat upright = testing_vision::RandomBits(static_cast<int>(map_.keypoints.size()), 32, 7);
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM, upright);
  MatchGuide guide{Pose2(), 0.1, 0.3};
  guide.upright = true;
  Features query = FeaturesSeenFrom(map_, Pose2());
  query.descriptors = testing_vision::RandomBits(query.descriptors.rows, 16, 8);
  EXPECT_THROW(matcher.FindNearest(query, guide), std::invalid_argument);
}

TEST_P(GuidedMatcherTest, FindsNothingFarAway) {
  const Features query = FeaturesSeenFrom(map_, Pose2());
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  EXPECT_TRUE(matcher.FindNearest(query, {Pose2(50.0, 0.0, 0.0), 0.1, 0.3}).empty());
  EXPECT_TRUE(matcher.FindNearest(query, {Pose2(-50.0, -50.0, 0.0), 0.1, 0.3}).empty());
  EXPECT_TRUE(matcher.FindNearest(Features(), {Pose2(), 0.1, 0.3}).empty());
}

TEST_P(GuidedMatcherTest, WildPriorsAreHarmless) {
  const Features query = FeaturesSeenFrom(map_, Pose2());
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wild : {1e300, -1e300, 1e18, -1e10, kNan, kInfinity, -kInfinity}) {
    EXPECT_TRUE(matcher.FindNearest(query, {Pose2(wild, 0.0, 0.0), 0.1, 0.3}).empty()) << wild;
    EXPECT_TRUE(matcher.FindNearest(query, {Pose2(0.0, wild, 0.0), 0.1, 0.3}).empty()) << wild;
    // A huge radius or angle may match all keypoints or none, but only existing ones.
    for (const MatchGuide& guide : {MatchGuide{Pose2(), wild, 0.3}, MatchGuide{Pose2(), 0.1, wild},
                                    MatchGuide{Pose2(0.0, 0.0, wild), 0.1, 0.3}}) {
      for (const Match& match : matcher.FindNearest(query, guide)) {
        EXPECT_GE(match.train, 0);
        EXPECT_LT(match.train, static_cast<int>(map_.keypoints.size()));
      }
    }
  }
}

TEST_P(GuidedMatcherTest, HugeRadiusSearchesTheWholeMap) {
  const Features query = FeaturesSeenFrom(map_, Pose2(0.3, 0.1, 1.0));
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  const std::vector<Match> matches = matcher.FindNearest(query, {Pose2(), 1e3, kPi});
  ASSERT_EQ(matches.size(), query.keypoints.size());
  for (const Match& match : matches) {
    EXPECT_EQ(match.distance, 0.0F);
  }
}

TEST_P(GuidedMatcherTest, ManyThreadsFindWhatOneFinds) {
  const Features query = FeaturesSeenFrom(map_, Pose2());
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  const MatchGuide guide{Pose2(0.02, 0.0, 0.1), 0.1, 0.4};
  const std::vector<Match> alone = matcher.FindNearest(query, guide);
  std::vector<std::vector<Match>> found(8);
  testing_vision::InThreads(8, [&](std::size_t i) { found[i] = matcher.FindNearest(query, guide); });
  for (const std::vector<Match>& matches : found) {
    ASSERT_EQ(matches.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(matches[i].train, alone[i].train);
    }
  }
}

TEST_P(GuidedMatcherTest, EmptyMapMatchesNothing) {
  const std::vector<Keypoint> none;
  const cv::Mat no_descriptors(0, 32, GetParam() ? CV_8U : CV_32F);
  const GuidedMatcher matcher(none, no_descriptors, kCellM);
  EXPECT_TRUE(matcher.FindNearest(FeaturesSeenFrom(map_, Pose2()), {Pose2(), 1.0, kPi}).empty());
}

TEST_P(GuidedMatcherTest, WhatWouldNeverEndIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double cell_m : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(GuidedMatcher(map_.keypoints, map_.descriptors, cell_m), std::invalid_argument) << cell_m;
  }
  const GuidedMatcher matcher(map_.keypoints, map_.descriptors, kCellM);
  MatchGuide guide;
  for (const int stride : {0, -1}) {
    guide.stride = stride;
    EXPECT_THROW(matcher.FindNearest(map_, guide), std::invalid_argument) << stride;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GuidedMatcherTest, ::testing::Bool(),
                         [](const auto& name) { return name.param ? "binary" : "float"; });

}  // namespace
}  // namespace floorloc
