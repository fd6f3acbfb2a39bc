// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace floorloc {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(AlignMapToTruth, RecoversTheMotionBetweenTheFrames) {
  const Pose2 truth_from_map(3.0, -2.0, 2.5);
  std::vector<MapFrame> frames;
  Trajectory truth;
  for (int i = 0; i < 20; ++i) {
    MapFrame frame;
    frame.stamp_ns = i * kSecond;
    frame.map_from_base = Pose2(0.3 * i, 0.02 * i * i, 0.1 * i);
    truth.push_back(StampedPose3::FromPose2(frame.stamp_ns, truth_from_map * frame.map_from_base));
    frames.push_back(frame);
  }
  const Pose2 error = AlignMapToTruth(frames, truth).Between(truth_from_map);
  EXPECT_LT(error.Log().norm(), 1e-9);
}

TEST(AlignMapToTruth, RefusesAMapWithoutTruth) {
  EXPECT_THROW(AlignMapToTruth({MapFrame()}, {}), std::invalid_argument);
}

TEST(ComputeScore, CountsRightWrongAndMissing) {
  const Pose2 truth_from_map(1.0, 2.0, 0.5);
  const std::vector<Pose2> truth(4, truth_from_map * Pose2(0.1, 0.2, 0.3));
  const std::vector<Fix> fixes = {
      {Pose2(0.101, 0.2, 0.3), 1.0}, {Pose2(0.2, 0.2, 0.3), 2.0}, {Pose2(0.1, 0.2, 0.4), 3.0}, {std::nullopt, 4.0}};
  const Score score = ComputeScore(fixes, truth, truth_from_map, Tolerance());
  EXPECT_EQ(score.frames, 4);
  EXPECT_EQ(score.localized, 3);
  EXPECT_EQ(score.right, 1);
  EXPECT_NEAR(score.position_median_m, 0.001, 1e-9);
  EXPECT_NEAR(score.position_p99_m, 0.1, 1e-9);
  EXPECT_NEAR(score.yaw_p99_rad, 0.1, 1e-9);
}

TEST(Percentile, OfNothingIsNotANumber) {
  EXPECT_TRUE(std::isnan(Percentile({}, 0.5)));
  EXPECT_EQ(Percentile({3.0, 1.0, 2.0}, 0.5), 2.0);
}

}  // namespace
}  // namespace floorloc
