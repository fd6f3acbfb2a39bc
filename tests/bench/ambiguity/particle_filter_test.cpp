// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/particle_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace floorloc {
namespace {

constexpr RectM kHall{0.0, 3.0, 0.0, 3.0};

// A 3 x 3 m hall in which every tile of 0.3 m but one looks the same.
FrameEvidence AnyTile(const Pose2& truth, double bits_of_truth) {
  FrameEvidence evidence;
  evidence.log_elsewhere = std::log(1e-6);
  for (int i = -9; i <= 9; ++i) {
    for (int k = -9; k <= 9; ++k) {
      const Pose2 place(truth.x() + 0.3 * i, truth.y() + 0.3 * k, truth.yaw());
      if (kHall.Contains(place.translation())) {
        evidence.poses.push_back({place, i == 0 && k == 0 ? bits_of_truth * std::log(2.0) : 0.0});
      }
    }
  }
  return evidence;
}

FrameEvidence One(const Pose2& pose) { return {{{pose, 0.0}}, std::log(1e-9)}; }

TEST(ParticleFilter, IsLocalizedByAFrameWithoutDoubt) {
  ParticleFilter filter({}, kHall);
  EXPECT_FALSE(filter.Localized());
  const Pose2 truth(1.0, 2.0, 0.5);
  filter.See(One(truth));
  const auto pose = filter.Localized();
  ASSERT_TRUE(pose);
  EXPECT_LT(truth.Between(*pose).translation().norm(), 0.005);
  EXPECT_NEAR(truth.Between(*pose).yaw(), 0.0, 0.01);
}

TEST(ParticleFilter, IsNotLocalizedWhileTilesAreEquallyLikely) {
  ParticleFilter filter({}, kHall);
  const Pose2 truth(1.1, 1.9, 0.2);
  for (int i = 0; i < 3; ++i) {
    filter.See(AnyTile(truth, 0.0));
    EXPECT_FALSE(filter.Localized()) << i;
  }
}

TEST(ParticleFilter, FollowsTheMotionAndSumsUpWhatFramesTell) {
  ParticleFilter filter({}, kHall);
  Pose2 truth(0.5, 0.5, 0.3);
  const Pose2 step(0.1, 0.0, 0.05);
  int frames = 0;
  while (!filter.Localized() && frames < 20) {
    filter.See(AnyTile(truth, 6.0));
    ++frames;
    filter.Move(step);
    truth = truth * step;
  }
  const auto pose = filter.Localized();
  ASSERT_TRUE(pose);
  EXPECT_GT(frames, 1);
  EXPECT_LT(truth.Between(*pose).translation().norm(), 0.03);
}

TEST(ParticleFilter, FramesThatTellNothingChangeNothing) {
  ParticleFilter filter({}, kHall);
  filter.See({});
  EXPECT_FALSE(filter.Localized());
  filter.See(One({1.0, 1.0, 0.0}));
  filter.See({});
  EXPECT_TRUE(filter.Localized());
}

TEST(ParticleFilter, IsDeterministicForASeed) {
  const auto pose_of = [](std::uint64_t seed) {
    ParticleFilter filter({.seed = seed}, kHall);
    filter.See(One({1.0, 1.0, 0.0}));
    return filter.Localized().value();
  };
  EXPECT_EQ(pose_of(1).x(), pose_of(1).x());
  EXPECT_NE(pose_of(1).x(), pose_of(2).x());
}

}  // namespace
}  // namespace floorloc
