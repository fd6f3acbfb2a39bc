// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/score.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace floorloc
