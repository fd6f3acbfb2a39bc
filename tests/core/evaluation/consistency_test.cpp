// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/consistency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Nees, IsTheSquaredErrorInStandardDeviations) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(4e-6, 9e-6, 1e-4).asDiagonal();
  // Errors of two, one and three standard deviations; the yaw error crosses +-pi.
  const Pose2 truth(1.0, 2.0, kPi - 0.01);
  EXPECT_NEAR(Nees(truth, Pose2(1.004, 2.003, -kPi + 0.02), covariance), 4.0 + 1.0 + 9.0, 1e-6);
}

TEST(Nees, TakesCorrelationIntoAccount) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  covariance(0, 1) = covariance(1, 0) = 0.8;
  // The variance is 1.8 along the correlation and 0.2 across it.
  EXPECT_NEAR(Nees(Pose2(), Pose2(1.0, 1.0, 0.0), covariance), 2.0 / 1.8, 1e-12);
  EXPECT_NEAR(Nees(Pose2(), Pose2(1.0, -1.0, 0.0), covariance), 2.0 / 0.2, 1e-12);
}

TEST(Nees, OfNoCovarianceIsInfinite) {
  EXPECT_TRUE(std::isinf(Nees(Pose2(), Pose2(0.1, 0.0, 0.0), Eigen::Matrix3d::Zero())));
}

TEST(SummarizeNees, BoundsAreThoseOfTheChiSquareTables) {
  // 95 % interval of chi-squared with 30 degrees of freedom: 16.791 to 46.979.
  const NeesSummary ten = SummarizeNees(std::vector<double>(10, 3.0));
  EXPECT_NEAR(ten.lower, 1.6791, 2e-3);
  EXPECT_NEAR(ten.upper, 4.6979, 2e-3);
  // With 300 degrees of freedom: 253.912 to 349.874.
  const NeesSummary hundred = SummarizeNees(std::vector<double>(100, 3.0));
  EXPECT_NEAR(hundred.lower, 2.53912, 1e-3);
  EXPECT_NEAR(hundred.upper, 3.49874, 1e-3);
}

TEST(SummarizeNees, SeparatesConsistentFromOverconfidentAndConservative) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> honest, overconfident, timid;
  const Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 2000; ++i) {
    const Pose2 estimate(normal(random), normal(random), 0.3 * normal(random));
    const Eigen::Matrix3d honest_covariance = Eigen::Vector3d(1.0, 1.0, 0.09).asDiagonal();
    honest.push_back(Nees(Pose2(), estimate, honest_covariance));
    overconfident.push_back(Nees(Pose2(), estimate, 0.8 * honest_covariance));
    timid.push_back(Nees(Pose2(), estimate, covariance));
  }
  EXPECT_TRUE(SummarizeNees(honest).Consistent()) << SummarizeNees(honest).mean;
  EXPECT_GT(SummarizeNees(overconfident).mean, SummarizeNees(overconfident).upper);
  EXPECT_LT(SummarizeNees(timid).mean, SummarizeNees(timid).lower);
}

TEST(SummarizeNees, OfNothingIsNothing) {
  EXPECT_EQ(SummarizeNees({}).count, 0U);
  EXPECT_EQ(SummarizeNees({}).mean, 0.0) << "no division by nothing";
}

TEST(EstimateRate, HasWilsonsInterval) {
  // Newcombe (1998), table 1: 81 of 263 gives 0.2553 to 0.3662, 15 of 148 gives 0.0624 to 0.1605.
  EXPECT_NEAR(EstimateRate(81, 263).lower, 0.2553, 1e-4);
  EXPECT_NEAR(EstimateRate(81, 263).upper, 0.3662, 1e-4);
  EXPECT_NEAR(EstimateRate(15, 148).lower, 0.0624, 1e-4);
  EXPECT_NEAR(EstimateRate(15, 148).upper, 0.1605, 1e-4);
}

TEST(EstimateRate, NeverAndAlwaysStayPossible) {
  EXPECT_EQ(EstimateRate(0, 20).lower, 0.0);
  EXPECT_NEAR(EstimateRate(0, 20).upper, 0.1611, 1e-4);
  EXPECT_EQ(EstimateRate(20, 20).upper, 1.0);
  EXPECT_EQ(EstimateRate(0, 0).upper, 1.0);
}

TEST(BinByDecade, PutsEveryForecastIntoItsDecade) {
  const std::vector<ReliabilityBin> bins = BinByDecade(
      {{1.0, true}, {0.5, false}, {0.1, false}, {0.03, true}, {1e-3, false}, {1e-30, false}, {0.0, true}}, 4);
  ASSERT_EQ(bins.size(), 4U);
  EXPECT_EQ(bins[0].count, 2U);
  EXPECT_EQ(bins[0].events, 1U);
  EXPECT_NEAR(bins[0].predicted, 0.75, 1e-12);
  EXPECT_NEAR(bins[0].observed.rate, 0.5, 1e-12);
  EXPECT_EQ(bins[1].count, 2U);
  EXPECT_EQ(bins[1].events, 1U);
  EXPECT_EQ(bins[2].count, 0U);
  EXPECT_EQ(bins[2].observed.upper, 1.0);
  EXPECT_EQ(bins[3].count, 3U);
  EXPECT_EQ(bins[3].events, 1U);
  EXPECT_EQ(bins[3].lower, 0.0);
  EXPECT_NEAR(bins[3].upper, 1e-3, 1e-15);
}

TEST(BinByDecade, ACalibratedForecasterLiesOnTheDiagonal) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Forecast> forecasts;
  for (int i = 0; i < 60000; ++i) {
    const double p = std::pow(10.0, -3.0 * uniform(random));
    forecasts.push_back({p, uniform(random) < p});
  }
  for (const ReliabilityBin& bin : BinByDecade(forecasts, 3)) {
    EXPECT_GT(bin.predicted, 0.8 * bin.observed.lower);
    EXPECT_LT(bin.predicted, 1.2 * bin.observed.upper);
    EXPECT_NEAR(bin.predicted / bin.observed.rate, 1.0, 0.25);
  }
}

}  // namespace
}  // namespace floorloc
