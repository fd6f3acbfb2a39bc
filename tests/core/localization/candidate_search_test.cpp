// SPDX-License-Identifier: Apache-2.0
#include "core/localization/candidate_search.h"

#include <gtest/gtest.h>

#include <vector>

namespace floorloc {
namespace {

constexpr double kRadiusM = 0.002;

// A match of a keypoint at (x, 0) with a residual of off_m under the identity.
void AddMatch(int query, double x, double off_m, FrameMatches* matches) {
  matches->matches.push_back({query, static_cast<int>(matches->matches.size()), 20.0F, 0.0F});
  matches->oriented.push_back({{x, 0.0}, {x, off_m}, 0.0, 0.0});
}

TEST(SupportingKeypointsTest, AreThoseWhoseMatchAgreesWithThePose) {
  FrameMatches matches;
  AddMatch(3, 0.1, 0.0, &matches);
  AddMatch(5, 0.2, 0.01, &matches);
  AddMatch(8, 0.3, 0.001, &matches);
  EXPECT_EQ(SupportingKeypoints(matches, Pose2(), kRadiusM), (std::vector<int>{3, 8}));
  EXPECT_TRUE(SupportingKeypoints(matches, Pose2(1.0, 0.0, 0.0), kRadiusM).empty());
}

// The indistinct search matches a keypoint with several map points, of which two may be close together.
TEST(SupportingKeypointsTest, AKeypointSupportsAPoseOnce) {
  FrameMatches matches;
  AddMatch(3, 0.1, 0.0, &matches);
  AddMatch(3, 0.1, 0.001, &matches);
  AddMatch(4, 0.2, 0.01, &matches);
  AddMatch(4, 0.2, 0.0, &matches);
  EXPECT_EQ(SupportingKeypoints(matches, Pose2(), kRadiusM), (std::vector<int>{3, 4}));
}

}  // namespace
}  // namespace floorloc
