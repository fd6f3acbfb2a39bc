// SPDX-License-Identifier: Apache-2.0
#include "core/registration/registration.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/core/registration/registration_test_support.h"

namespace floorloc {
namespace {

using testing_registration::Join;
using testing_registration::MatchGenerator;

constexpr double kPi = std::numbers::pi;
const SearchRegion kHall{24.0};

RegistrationResult Register(const std::vector<OrientedMatch>& matches, const SearchRegion& region = kHall) {
  return RegisterSe2(matches, region, RegistrationOptions{});
}

// Error of a pose at the centroid of the source points, where it is most certain: metres, radians.
std::pair<double, double> ErrorOf(const Pose2& estimate, const Pose2& truth) {
  const Eigen::Vector2d middle(0.25, 0.0);
  return {(estimate * middle - truth * middle).norm(), std::abs(WrapAngle(estimate.yaw() - truth.yaw()))};
}

TEST(RegistrationTest, RecoversEveryPoseFromCleanMatches) {
  MatchGenerator draw(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose2 truth = draw.RandomPose();
    const RegistrationResult result = Register(draw.Right(60, truth, 0.0));
    ASSERT_TRUE(result.ok()) << truth << " " << ToString(result.status);
    const auto [away_m, turned_rad] = ErrorOf(result.target_from_source, truth);
    EXPECT_LT(away_m, 1e-9) << truth;
    EXPECT_LT(turned_rad, 1e-9) << truth;
    EXPECT_EQ(result.inliers.size(), 60U) << truth;
    EXPECT_LT(result.p_wrong, 1e-4);
    EXPECT_TRUE(result.alternatives.empty());
  }
}

TEST(RegistrationTest, YawNearTheSeamIsAsGoodAsAny) {
  MatchGenerator draw(2);
  for (const double yaw : {kPi, -kPi + 1e-9, kPi - 1e-6, -kPi + 0.05, kPi - 0.05, 0.0, 0.5 * kPi, -0.5 * kPi}) {
    const Pose2 truth(1.0, -2.0, yaw);
    const RegistrationResult result = Register(draw.Right(30, truth, 2e-4));
    ASSERT_TRUE(result.ok()) << yaw;
    EXPECT_LT(ErrorOf(result.target_from_source, truth).second, 3e-3) << yaw;
    EXPECT_EQ(result.inliers.size(), 30U) << yaw;
  }
}

TEST(RegistrationTest, EightyPercentOutliersDoNotMatter) {
  MatchGenerator draw(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose2 truth = draw.RandomPose();
    auto matches = Join(draw.Right(40, truth, 3e-4), draw.Wrong(160, truth.translation(), 5.0));
    draw.Shuffle(&matches);
    const RegistrationResult result = Register(matches);
    ASSERT_TRUE(result.ok()) << trial << " " << truth << " " << ToString(result.status);
    const auto [away_m, turned_rad] = ErrorOf(result.target_from_source, truth);
    EXPECT_LT(away_m, 5e-4) << trial;
    EXPECT_LT(turned_rad, 3e-3) << trial;
    EXPECT_GE(result.inliers.size(), 39U) << trial;
    EXPECT_LE(result.inliers.size(), 43U) << trial;
  }
}

TEST(RegistrationTest, CovarianceMatchesTheScatter) {
  MatchGenerator draw(4);
  constexpr int kTrials = 400;
  double nees = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Pose2 truth = draw.RandomPose();
    const RegistrationResult result = Register(draw.Right(100, truth, 4e-4));
    ASSERT_TRUE(result.ok());
    const Pose2& pose = result.target_from_source;
    const Eigen::Vector3d error(pose.x() - truth.x(), pose.y() - truth.y(), WrapAngle(pose.yaw() - truth.yaw()));
    nees += error.dot(result.covariance.inverse() * error);
  }
  // 95 % bounds of the mean of kTrials chi-squared values with 3 degrees of freedom; sigma is estimated from 200
  // residuals.
  const double spread = 1.96 * std::sqrt(2.0 * 3.0 / kTrials);
  EXPECT_GT(nees / kTrials, 3.0 - spread);
  EXPECT_LT(nees / kTrials, 3.0 * 200.0 / 195.0 + spread);
}

TEST(RegistrationTest, RmsIsTheResidualOfTheInliers) {
  MatchGenerator draw(5);
  const Pose2 truth(0.3, 0.2, 1.0);
  const auto matches = draw.Right(400, truth, 3e-4);
  EXPECT_NEAR(Register(matches).rms_m, 3e-4 * std::sqrt(2.0), 3e-5);
}

TEST(RegistrationTest, TooFewMatchesSaysSo) {
  MatchGenerator draw(6);
  EXPECT_EQ(Register({}).status, RegistrationStatus::kTooFewMatches);
  EXPECT_EQ(Register(draw.Right(7, Pose2(), 0.0)).status, RegistrationStatus::kTooFewMatches);
  EXPECT_TRUE(Register(draw.Right(8, Pose2(), 0.0)).ok());
}

TEST(RegistrationTest, TooFewInliersSaysSo) {
  MatchGenerator draw(7);
  auto matches = Join(draw.Right(5, Pose2(1.0, 1.0, 1.0), 0.0), draw.Wrong(40, {1.0, 1.0}, 50.0));
  EXPECT_EQ(Register(matches).status, RegistrationStatus::kTooFewInliers);
}

TEST(RegistrationTest, FewInliersAmongManyMatchesAreNotSignificant) {
  MatchGenerator draw(8);
  RegistrationOptions options;
  options.min_inliers = 3;
  const auto matches = Join(draw.Right(4, Pose2(0.1, 0.1, 0.3), 0.0), draw.Wrong(300, {0.3, 0.2}, 0.8));
  EXPECT_EQ(RegisterSe2(matches, {0.3}, options).status, RegistrationStatus::kNotSignificant);
}

TEST(RegistrationTest, TwoEqualPosesAreAmbiguous) {
  MatchGenerator draw(9);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose2 one = draw.RandomPose();
    const Pose2 other = one * Pose2(0.7, -0.4, draw.Angle());
    auto matches = Join(draw.Right(40, one, 2e-4), draw.Right(40, other, 2e-4));
    draw.Shuffle(&matches);
    const RegistrationResult result = Register(matches);
    ASSERT_EQ(result.status, RegistrationStatus::kAmbiguous) << trial;
    EXPECT_GT(result.p_wrong, 0.1);
    ASSERT_EQ(result.alternatives.size(), 2U);
    double sum = 0.0;
    bool found_one = false;
    bool found_other = false;
    for (const PoseHypothesis& hypothesis : result.alternatives) {
      sum += hypothesis.weight;
      found_one |= ErrorOf(hypothesis.target_from_source, one).first < 1e-3;
      found_other |= ErrorOf(hypothesis.target_from_source, other).first < 1e-3;
      EXPECT_NEAR(hypothesis.inliers, 40, 2);
    }
    EXPECT_NEAR(sum, 1.0, 1e-3);
    EXPECT_TRUE(found_one && found_other);
    EXPECT_GE(result.alternatives[0].weight, result.alternatives[1].weight);
  }
}

TEST(RegistrationTest, AWeakRivalDoesNotStopAStrongPose) {
  MatchGenerator draw(10);
  const Pose2 strong(1.0, 2.0, 0.5);
  const auto matches = Join(draw.Right(100, strong, 2e-4), draw.Right(12, Pose2(3.0, 1.0, -2.0), 2e-4));
  const RegistrationResult result = Register(matches);
  ASSERT_TRUE(result.ok());
  EXPECT_LT(ErrorOf(result.target_from_source, strong).first, 1e-3);
}

TEST(RegistrationTest, ChanceIsNeverAccepted) {
  MatchGenerator draw(11);
  for (int trial = 0; trial < 1000; ++trial) {
    const bool with_prior = trial % 2 == 0;
    const double side_m = with_prior ? 0.8 : 5.0;
    const auto matches = draw.Wrong(20 + trial % 180, {0.0, 0.0}, side_m);
    EXPECT_FALSE(Register(matches, {side_m * side_m}).ok()) << trial;
  }
}

TEST(RegistrationTest, SameInputSameAnswer) {
  MatchGenerator draw(12);
  const Pose2 truth = draw.RandomPose();
  const auto matches = Join(draw.Right(40, truth, 3e-4), draw.Wrong(100, truth.translation(), 3.0));
  const RegistrationResult once = Register(matches);
  const RegistrationResult again = Register(matches);
  EXPECT_EQ(once.inliers, again.inliers);
  EXPECT_EQ(once.target_from_source.x(), again.target_from_source.x());
  EXPECT_EQ(once.target_from_source.yaw(), again.target_from_source.yaw());
  EXPECT_EQ(once.covariance, again.covariance);
  EXPECT_EQ(once.p_wrong, again.p_wrong);
}

// Equivariance: the result transforms with the target frame.
TEST(RegistrationTest, AnswerMovesWithTheTargetFrame) {
  MatchGenerator draw(13);
  const Pose2 truth(0.2, 0.1, 0.4);
  auto matches = draw.Right(50, truth, 3e-4);
  const Pose2 pose = Register(matches).target_from_source;
  const Pose2 motion(300.0, -200.0, 2.0);
  for (OrientedMatch& m : matches) {
    m.target_m = motion * m.target_m;
    m.target_angle_rad = WrapAngle(m.target_angle_rad + motion.yaw());
  }
  const auto [away_m, turned_rad] = ErrorOf(Register(matches).target_from_source, motion * pose);
  EXPECT_LT(away_m, 1e-7);
  EXPECT_LT(turned_rad, 1e-7);
}

TEST(RegistrationTest, DegenerateMatchesAreNoPose) {
  const OrientedMatch match{{0.2, 0.1}, {1.0, 1.0}, 0.0, 0.3};
  EXPECT_FALSE(Register(std::vector<OrientedMatch>(50, match)).ok());  // one point does not determine the yaw
}

TEST(RegistrationTest, WildMatchesAreHarmless) {
  MatchGenerator draw(14);
  for (const double wild : {1e300, -1e18, std::numeric_limits<double>::quiet_NaN()}) {
    auto matches = draw.Right(20, Pose2(), 0.0);
    for (int i = 0; i < 5; ++i) {
      matches[static_cast<std::size_t>(i)].target_m.x() = wild;
    }
    EXPECT_NO_THROW(Register(matches)) << wild;
  }
}

TEST(RegistrationOptionsTest, RefusesNonsense) {
  const auto with = [](auto member, auto value) {
    RegistrationOptions options;
    options.*member = value;
    return options;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(RegistrationOptions().Check());
  EXPECT_THROW(with(&RegistrationOptions::inlier_radius_m, 0.0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::vote_cell_m, kNan).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::vote_cell_rad, 0.0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::candidates, 0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::ransac_iterations, 0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::min_inliers, 2).Check(), std::invalid_argument);
  EXPECT_THROW(with(&RegistrationOptions::max_p_wrong, 0.0).Check(), std::invalid_argument);
}

}  // namespace
TEST(RegistrationOptions, LengthsFollowTheResolution) {
  const RegistrationOptions options;
  const RegistrationOptions same = options.ScaledTo(7e-4);
  const RegistrationOptions twice = options.ScaledTo(1.4e-3);
  EXPECT_DOUBLE_EQ(same.inlier_radius_m, options.inlier_radius_m);
  EXPECT_DOUBLE_EQ(twice.inlier_radius_m, 2.0 * options.inlier_radius_m);
  EXPECT_DOUBLE_EQ(twice.vote_cell_m, 2.0 * options.vote_cell_m);
  EXPECT_DOUBLE_EQ(twice.position_noise_floor_m, 2.0 * options.position_noise_floor_m);
  EXPECT_EQ(twice.min_inliers, options.min_inliers);
}

TEST(KeypointNoise, CountsTheFittedParameters) {
  RegistrationOptions options;
  options.position_noise_floor_m = 1e-9;
  // Variance per coordinate is rms^2 * n / (2 n - 3): 2 n coordinates, 3 fitted parameters.
  EXPECT_NEAR(KeypointNoise(1e-3, 100000, options), 1e-3 / std::sqrt(2.0), 1e-8);
  EXPECT_NEAR(KeypointNoise(1e-3, 6, options), 1e-3 * std::sqrt(6.0 / 9.0), 1e-8);
}

}  // namespace floorloc
