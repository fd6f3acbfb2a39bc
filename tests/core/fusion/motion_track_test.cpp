// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/motion_track.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

TEST(MotionTrack, AnIncrementThatComesLateTakesItsPlace) {
  MotionTrack track;
  EXPECT_EQ(track.Add({0, 10, Pose2(1, 0, 0), {}}), MessageOutcome::kUsed);
  EXPECT_EQ(track.Add({10, 30, Pose2(3, 0, 0), {}}),
            MessageOutcome::kUsed);  // starts at 20, which has not been measured yet
  EXPECT_EQ(track.Add({10, 20, Pose2(2, 0, 0), {}}), MessageOutcome::kUsedLate);
  EXPECT_NEAR(track.Between(10, 20).motion.x(), 2.0, 1e-12);
  EXPECT_NEAR(track.Between(20, 30).motion.x(), 3.0, 1e-12);
  EXPECT_NEAR(track.Between(0, 30).path_m, 6.0, 1e-12);
}

TEST(MotionTrack, KnowsItsHoles) {
  MotionTrack track;
  track.Add({0, 10, Pose2(1, 0, 0), {}});
  track.Add({20, 30, Pose2(1, 0, 0), {}});
  EXPECT_EQ(track.CoveredUntil(5, 100), 10);
  EXPECT_EQ(track.CoveredUntil(12, 100), 12);
  EXPECT_EQ(track.NextStart(12, 100), 20);
  EXPECT_EQ(track.CoveredUntil(20, 25), 25);
  EXPECT_EQ(track.NextStart(30, 100), 100);
}

TEST(MotionTrack, DropsWhatIsLater) {
  MotionTrack track;
  track.Add({0, 10, Pose2(1, 0, 0), {}});
  track.Add({10, 20, Pose2(1, 0, 0), {}});
  track.DropAfter(10);
  EXPECT_EQ(track.newest_ns(), 10);
  track.DropAfter(9);
  EXPECT_TRUE(track.empty());
}

TEST(MotionTrack, CutsAnIncrementAsAMotionOfConstantTwist) {
  MotionTrack track;
  const Pose2 motion = Pose2::Exp({1.0, 0.0, 0.8});
  track.Add({0, 100, motion, Eigen::Matrix3d::Identity()});
  const TrackMotion first = track.Between(0, 30);
  EXPECT_LT((first.motion * track.Between(30, 100).motion).Between(motion).Log().norm(), 1e-12);
  EXPECT_TRUE(first.has_covariance);
  EXPECT_NEAR(first.covariance.trace(), 0.9, 1e-12);
}

}  // namespace
}  // namespace floorloc
