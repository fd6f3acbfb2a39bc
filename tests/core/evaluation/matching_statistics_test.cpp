// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/matching_statistics.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

Keypoint At(double x_m, double y_m) {
  Keypoint k;
  k.x_m = static_cast<float>(x_m);
  k.y_m = static_cast<float>(y_m);
  return k;
}

// Rotation by 90 degrees and a shift: (1, 0) -> (5, 1), (2, 0) -> (5, 2), (0, 1) -> (4, 0).
const Pose2 kTargetFromQuery(5.0, 0.0, 1.5707963267948966);

TEST(Repeatability, CountsQueriesThatAreFoundAgain) {
  const std::vector<Keypoint> query = {At(1, 0), At(2, 0), At(0, 1)};
  const std::vector<Keypoint> target = {At(5.004, 1.0), At(5.0, 2.02), At(4.0, -0.009), At(9, 9)};
  EXPECT_DOUBLE_EQ(Repeatability(query, target, kTargetFromQuery, 0.01), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(Repeatability(query, target, kTargetFromQuery, 0.03), 1.0);
  EXPECT_DOUBLE_EQ(Repeatability(query, target, Pose2(), 0.01), 0.0);
}

TEST(Repeatability, IsMeasuredByDistanceNotByAxis) {
  EXPECT_DOUBLE_EQ(Repeatability({At(0, 0)}, {At(0.008, 0.008)}, Pose2(), 0.01), 0.0);
}

TEST(Repeatability, OfNothingIsZero) {
  EXPECT_EQ(Repeatability({}, {At(0, 0)}, Pose2(), 0.01), 0.0);
  EXPECT_EQ(Repeatability({At(0, 0)}, {}, Pose2(), 0.01), 0.0);
}

TEST(FindCorrectMatches, JudgesByTheTruePose) {
  const std::vector<Keypoint> query = {At(1, 0), At(2, 0)};
  const std::vector<Keypoint> target = {At(5, 2), At(5, 1)};
  const std::vector<Match> matches = {{0, 1, 1.0F, 2.0F}, {1, 1, 1.0F, 2.0F}, {1, 0, 1.0F, 2.0F}};
  const std::vector<bool> right = FindCorrectMatches(matches, query, target, kTargetFromQuery, 0.01);
  EXPECT_EQ(right, (std::vector<bool>{true, false, true}));
  EXPECT_DOUBLE_EQ(MatchingScore(right, 8), 0.25);
  EXPECT_EQ(MatchingScore({}, 0), 0.0);
}

}  // namespace
}  // namespace floorloc
