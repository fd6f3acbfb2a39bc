// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/deviation_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace floorloc {
namespace {

std::array<double, 9> Covariance(double xx, double xy, double yy) { return {xx, xy, 0, xy, yy, 0, 0, 0, 1}; }

TEST(DeviationRangeTest, OfARoundDistributionIsRayleighs) {
  EXPECT_NEAR(DeviationRange(Covariance(4e-6, 0, 4e-6)), 2e-3 * std::sqrt(-2.0 * std::log(0.05)), 1e-7);
}

TEST(DeviationRangeTest, OfALineIsTheNormalDistributions) {
  EXPECT_NEAR(DeviationRange(Covariance(1.0, 0, 0)), 1.959964, 1e-4);
  EXPECT_NEAR(DeviationRange(Covariance(0.5, 0.5, 0.5)), 1.959964, 1e-4) << "turned";
}

TEST(DeviationRangeTest, OfNoUncertaintyIsZero) { EXPECT_EQ(DeviationRange(Covariance(0, 0, 0)), 0.0); }

TEST(DeviationRangeTest, HoldsNinetyFivePercentOfSamples) {
  constexpr int kSamples = 200'000;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double ratio : {0.1, 0.4, 0.8}) {
    // An ellipse of half axes 1 and ratio, turned by 0.7.
    const double c = std::cos(0.7);
    const double s = std::sin(0.7);
    const double radius = DeviationRange(
        Covariance(c * c + ratio * ratio * s * s, (1.0 - ratio * ratio) * c * s, s * s + ratio * ratio * c * c));
    int inside = 0;
    for (int i = 0; i < kSamples; ++i) {
      inside += std::hypot(normal(random), ratio * normal(random)) <= radius ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(inside) / kSamples, 0.95, 0.0025) << ratio;
  }
}

}  // namespace
}  // namespace floorloc
