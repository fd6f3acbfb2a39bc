// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/fix_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace floorloc {
namespace {

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

TEST(ComputeScore, SeparatesAccuracyFromPrecision) {
  // Three poses around (1.010, 2.000): a bias of 10 mm in x, a spread in y.
  const std::vector<Pose2> truth(3, Pose2(1.0, 2.0, 0.0));
  const std::vector<Fix> fixes = {
      {Pose2(1.01, 2.0, 0.02), 1.0}, {Pose2(1.01, 2.003, 0.0), 1.0}, {Pose2(1.01, 1.997, -0.02), 1.0}};
  const Score score = ComputeScore(fixes, truth, Pose2(), Tolerance());
  const double spread = std::sqrt(2.0 / 3.0);
  EXPECT_NEAR(score.accuracy.x_m, 0.010, 1e-9);
  EXPECT_NEAR(score.accuracy.y_m, 0.003 * spread, 1e-9);
  EXPECT_NEAR(score.precision.x_m, 0.0, 1e-9);
  EXPECT_NEAR(score.precision.y_m, 0.003 * spread, 1e-9);
  EXPECT_NEAR(score.precision.yaw_rad, 0.02 * spread, 1e-9);
  EXPECT_NEAR(score.position_mean_m, (0.010 + 2.0 * std::hypot(0.010, 0.003)) / 3.0, 1e-9);
  EXPECT_NEAR(score.yaw_mean_rad, 0.04 / 3.0, 1e-9);
}

TEST(ComputeScore, HeadingErrorsDoNotJumpAtHalfATurn) {
  const Score score = ComputeScore({{Pose2(0.0, 0.0, -3.14), 1.0}}, {Pose2(0.0, 0.0, 3.14)}, Pose2(), Tolerance());
  EXPECT_EQ(score.right, 1);
  EXPECT_NEAR(score.yaw_mean_rad, 2.0 * (M_PI - 3.14), 1e-9);
}

TEST(ComputeScore, OfNothingLocalizedHasNoErrors) {
  const Score score = ComputeScore({{std::nullopt, 1.0}}, {Pose2()}, Pose2(), Tolerance());
  EXPECT_EQ(score.localized, 0);
  EXPECT_TRUE(std::isnan(score.position_mean_m));
  EXPECT_TRUE(std::isnan(score.accuracy.x_m));
}

}  // namespace
}  // namespace floorloc
