// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/correlation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace floorloc {
namespace {

TEST(IncompleteBeta, HasItsClosedForms) {
  for (const double x : {0.0, 0.01, 0.3, 0.5, 0.77, 0.999, 1.0}) {
    EXPECT_NEAR(IncompleteBeta(1, 1, x), x, 1e-14);
    EXPECT_NEAR(IncompleteBeta(3, 1, x), x * x * x, 1e-14);
    EXPECT_NEAR(IncompleteBeta(1, 2.5, x), 1 - std::pow(1 - x, 2.5), 1e-14);
    EXPECT_NEAR(IncompleteBeta(2, 2, x), x * x * (3 - 2 * x), 1e-14);
    EXPECT_NEAR(IncompleteBeta(0.5, 0.5, x), 2 / std::numbers::pi * std::asin(std::sqrt(x)), 1e-14);
  }
}

TEST(IncompleteBeta, IsSymmetric) {
  for (const double a : {0.5, 3.0, 60.0, 1000.0}) {
    for (const double x : {0.02, 0.4, 0.9}) {
      EXPECT_NEAR(IncompleteBeta(a, 0.5, x), 1 - IncompleteBeta(0.5, a, 1 - x), 1e-12) << a << " " << x;
    }
  }
}

// Mean 3 and 4; sums of squares 10 and 6, of products 6: r = 6 / sqrt(60). t = r sqrt(3 / (1 - r^2)) = 2.1213 with 3
// degrees of freedom, of which p has the closed form 1 - 2/pi (a + a' / (1 + a'^2)), a' = t / sqrt(3), a = atan(a').
TEST(PearsonCorrelation, ByHand) {
  const auto found = PearsonCorrelation({1, 2, 3, 4, 5}, {2, 4, 5, 4, 5});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->r, 6 / std::sqrt(60.0), 1e-14);
  EXPECT_EQ(found->samples, 5u);
  const double slope = 2.1213203435596424 / std::sqrt(3.0);
  EXPECT_NEAR(found->p, 1 - 2 / std::numbers::pi * (std::atan(slope) + slope / (1 + slope * slope)), 1e-12);
}

// Two-sided critical values of the t distribution from standard tables: 5 % at 2.228 (10 degrees of freedom) and at
// 2.048 (28), 1 % at 2.763 (28).
TEST(PearsonCorrelation, HasTheCriticalValuesOfTables) {
  struct Row {
    double t, freedom, p;
  };
  for (const Row& row : {Row{2.228, 10, 0.05}, Row{2.048, 28, 0.05}, Row{2.763, 28, 0.01}}) {
    EXPECT_NEAR(IncompleteBeta(row.freedom / 2, 0.5, row.freedom / (row.freedom + row.t * row.t)), row.p, 6e-5)
        << "tables have three decimals";
  }
}

TEST(PearsonCorrelation, OfALine) {
  const auto found = PearsonCorrelation({1, 2, 3, 4}, {8, 6, 4, 2});
  ASSERT_TRUE(found.has_value());
  EXPECT_DOUBLE_EQ(found->r, -1);
  EXPECT_NEAR(found->p, 0, 1e-12);
}

TEST(PearsonCorrelation, NeedsThreeSamplesThatChange) {
  EXPECT_FALSE(PearsonCorrelation({1, 2}, {1, 2}).has_value());
  EXPECT_FALSE(PearsonCorrelation({}, {}).has_value());
  EXPECT_FALSE(PearsonCorrelation({1, 2, 3}, {4, 4, 4}).has_value());
  EXPECT_FALSE(PearsonCorrelation({7, 7, 7}, {1, 2, 3}).has_value());
}

// For independent pairs p is uniformly distributed.
TEST(PearsonCorrelation, PIsUniformWithoutACorrelation) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> any;
  constexpr int kTrials = 4000;
  int below_5_percent = 0;
  int below_half = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> x(7);
    std::vector<double> y(7);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = any(rng);
      y[i] = any(rng);
    }
    const double p = PearsonCorrelation(x, y)->p;
    below_5_percent += p < 0.05 ? 1 : 0;
    below_half += p < 0.5 ? 1 : 0;
  }
  EXPECT_NEAR(below_5_percent, 0.05 * kTrials, 4 * std::sqrt(0.05 * 0.95 * kTrials));
  EXPECT_NEAR(below_half, 0.5 * kTrials, 4 * std::sqrt(0.25 * kTrials));
}

}  // namespace
}  // namespace floorloc
