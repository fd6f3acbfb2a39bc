// SPDX-License-Identifier: Apache-2.0
#include "core/registration/voting.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/registration/registration_test_support.h"

namespace floorloc {
namespace {

using testing_registration::Join;
using testing_registration::MatchGenerator;

const Eigen::Vector2d kMiddle(0.25, 0.0);  // centre of the source points of MatchGenerator

// For any position of the pose relative to the cell borders, including the yaw wrap at +-pi.
TEST(VotingTest, APeakHoldsAllRightMatches) {
  MatchGenerator draw(1);
  const RegistrationOptions options;
  for (double yaw = -std::numbers::pi; yaw <= std::numbers::pi; yaw += 0.05) {
    const Pose2 truth = Pose2(draw.Uniform(-1.0, 1.0), draw.Uniform(-1.0, 1.0), yaw);
    const auto matches = Join(draw.Right(40, truth, 1e-4), draw.Wrong(40, truth.translation(), 3.0));
    const std::vector<VotePeak> peaks = FindVotePeaks(matches, kMiddle, options);
    ASSERT_FALSE(peaks.empty());
    const auto right = std::count_if(peaks[0].matches.begin(), peaks[0].matches.end(), [](int i) { return i < 40; });
    EXPECT_EQ(right, 40) << truth;
  }
}

TEST(VotingTest, PeaksComeBestFirstAndApart) {
  MatchGenerator draw(2);
  RegistrationOptions options;
  options.candidates = 4;
  const Pose2 one(1.0, 1.0, 0.0);
  const Pose2 other(1.0, 1.0, 1.0);
  const auto matches =
      Join(Join(draw.Right(20, one, 0.0), draw.Right(30, other, 0.0)), draw.Wrong(50, {0.0, 0.0}, 9.0));
  const std::vector<VotePeak> peaks = FindVotePeaks(matches, kMiddle, options);
  ASSERT_EQ(peaks.size(), 4U);
  EXPECT_TRUE(
      std::is_sorted(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.votes > b.votes; }));
  EXPECT_GE(peaks[0].votes, 30);
  EXPECT_GE(peaks[1].votes, 20);
  EXPECT_LT(peaks[2].votes, 10);
  for (const VotePeak& peak : peaks) {
    EXPECT_EQ(static_cast<int>(peak.matches.size()), peak.votes);
    EXPECT_TRUE(std::is_sorted(peak.matches.begin(), peak.matches.end()));
  }
}

TEST(VotingTest, NoMatchesNoPeaks) { EXPECT_TRUE(FindVotePeaks({}, kMiddle, {}).empty()); }

}  // namespace
}  // namespace floorloc
