// SPDX-License-Identifier: Apache-2.0
#include "core/registration/significance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/registration/registration.h"

namespace floorloc {
namespace {

TEST(SignificanceTest, MoreInliersAreLessLikelyByChance) {
  for (const double chance : {1e-6, 1e-3, 0.1, 0.5}) {
    for (int inliers = 1; inliers < 200; ++inliers) {
      EXPECT_LE(Log10Nfa(200, inliers + 1, chance, 1.0), Log10Nfa(200, inliers, chance, 1.0) + 1e-9)
          << inliers << " " << chance;
    }
    EXPECT_LT(Log10Nfa(200, 150, chance, 1.0), Log10Nfa(200, 140, chance, 1.0));
  }
}

TEST(SignificanceTest, MoreMatchesTrialsAndChanceAreLessSignificant) {
  const double base = Log10Nfa(100, 20, 0.01, 10.0);
  EXPECT_GT(Log10Nfa(200, 20, 0.01, 10.0), base);
  EXPECT_GT(Log10Nfa(100, 20, 0.02, 10.0), base);
  EXPECT_NEAR(Log10Nfa(100, 20, 0.01, 1000.0), base + 2.0, 1e-9);
}

TEST(SignificanceTest, AgreesWithTheBinomialTail) {
  // P(X >= 2), X ~ B(3, 1/2) = 4 / 8; P(X >= 3), X ~ B(3, 0.1) = 0.001; P(X >= 1), X ~ B(2, 0.1) = 0.19
  EXPECT_NEAR(Log10Nfa(3, 2, 0.5, 1.0), std::log10(0.5), 1e-9);
  EXPECT_NEAR(Log10Nfa(3, 3, 0.1, 1.0), -3.0, 1e-9);
  EXPECT_NEAR(Log10Nfa(2, 1, 0.1, 1.0), std::log10(0.19), 1e-9);
  EXPECT_NEAR(Log10Nfa(50, 0, 0.1, 100.0), 2.0, 1e-9);
}

TEST(SignificanceTest, ExtremesAreFinite) {
  EXPECT_TRUE(std::isfinite(Log10Nfa(100000, 100000, 1e-12, 1e10)));
  EXPECT_TRUE(std::isfinite(Log10Nfa(1, 1, 0.0, 1.0)));
  EXPECT_TRUE(std::isfinite(Log10Nfa(1, 1, 1.0, 1.0)));
}

TEST(SignificanceTest, ChancePosesFallWithTheInliersAndTheSearchedArea) {
  const RegistrationOptions options;
  for (int inliers = 8; inliers < 60; ++inliers) {
    EXPECT_LT(Log10NfaOfPose(60, inliers + 1, {24.0}, options), Log10NfaOfPose(60, inliers, {24.0}, options));
    EXPECT_LT(Log10NfaOfPose(60, inliers, {24.0}, options), Log10NfaOfPose(60, inliers, {0.3}, options));
  }
}

}  // namespace
}  // namespace floorloc
