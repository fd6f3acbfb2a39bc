// SPDX-License-Identifier: Apache-2.0
#include "core/io/trajectory_twist.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

constexpr std::int64_t kMs = 1'000'000;
const Eigen::Vector3d kTwist(0.8, -0.1, 0.6);

// Poses every 40 ms from 1 s to 1.4 s.
Trajectory Driven() {
  Trajectory trajectory;
  for (int i = 0; i <= 10; ++i) {
    trajectory.push_back(
        StampedPose3::FromPose2((1000 + 40 * i) * kMs, Pose2(3.0, 2.0, 1.0) * Pose2::Exp(0.04 * i * kTwist)));
  }
  return trajectory;
}

TEST(TrajectoryTwistTest, IsTheVelocityInTheBodysFrame) {
  for (const int ms : {1000, 1010, 1213, 1399, 1400}) {  // also at both ends
    const auto twist = TwistAt(Driven(), ms * kMs);
    ASSERT_TRUE(twist) << ms;
    EXPECT_LT((*twist - kTwist).norm(), 1e-6) << ms;
  }
}

TEST(TrajectoryTwistTest, IsUnknownOutsideAndInGaps) {
  EXPECT_FALSE(TwistAt({}, 1000 * kMs));
  EXPECT_FALSE(TwistAt(Driven(), 900 * kMs));
  EXPECT_FALSE(TwistAt(Driven(), 1500 * kMs));
  Trajectory gap = Driven();
  gap.push_back(StampedPose3::FromPose2(5000 * kMs, Pose2()));
  EXPECT_FALSE(TwistAt(gap, 3000 * kMs));
}

}  // namespace
}  // namespace floorloc
