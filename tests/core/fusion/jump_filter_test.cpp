// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/jump_filter.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

constexpr double kDeg = 0.017453292519943295;

TEST(JumpFilter, DropsWhatJumpsTooFarOrTurnsTooMuch) {
  JumpFilter filter{JumpFilterOptions()};
  EXPECT_TRUE(filter.Accept(Pose2(5.0, 5.0, 3.1), std::nullopt));
  EXPECT_TRUE(filter.Accept(Pose2(5.19, 5.0, 3.1), std::nullopt));
  EXPECT_FALSE(filter.Accept(Pose2(5.40, 5.0, 3.1), std::nullopt));
  EXPECT_TRUE(filter.Accept(Pose2(5.19, 5.0, -3.1), std::nullopt)) << "4.8 degrees, across half a turn";
  EXPECT_FALSE(filter.Accept(Pose2(5.19, 5.0, -3.1 + 11.0 * kDeg), std::nullopt));
}

TEST(JumpFilter, ComparesWithTheLastAcceptedPose) {
  JumpFilter filter{JumpFilterOptions()};
  EXPECT_TRUE(filter.Accept(Pose2(0.0, 0.0, 0.0), std::nullopt));
  EXPECT_FALSE(filter.Accept(Pose2(0.3, 0.0, 0.0), std::nullopt));
  EXPECT_FALSE(filter.Accept(Pose2(0.35, 0.0, 0.0), std::nullopt))
      << "near the dropped pose, far from the accepted one";
  EXPECT_TRUE(filter.Accept(Pose2(0.1, 0.0, 0.0), std::nullopt));
}

TEST(JumpFilter, OdometryPropagatesTheLastPose) {
  JumpFilter filter{JumpFilterOptions()};
  EXPECT_TRUE(filter.Accept(Pose2(1.0, 1.0, 90.0 * kDeg), Pose2(0.0, 0.0, 0.0)));
  EXPECT_TRUE(filter.Accept(Pose2(1.0, 2.0, 90.0 * kDeg), Pose2(1.0, 0.0, 0.0)));
  EXPECT_FALSE(filter.Accept(Pose2(1.0, 2.0, 90.0 * kDeg), Pose2(2.0, 0.0, 0.0)));
}

}  // namespace
}  // namespace floorloc
