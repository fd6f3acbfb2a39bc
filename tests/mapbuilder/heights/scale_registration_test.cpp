// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/scale_registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

constexpr double kAreaM2 = 0.13;

// Matches of a view of 0.3 x 0.4 m: true ones under a similarity, with noise, and wrong ones.
std::vector<OrientedMatch> Matches(int right, int wrong, const std::complex<double>& factor) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-0.15, 0.15);
  std::uniform_real_distribution<double> y(-0.2, 0.2);
  std::uniform_real_distribution<double> angle(-3.1, 3.1);
  std::normal_distribution<double> noise(0.0, 2e-4);
  std::vector<OrientedMatch> matches;
  for (int i = 0; i < right + wrong; ++i) {
    OrientedMatch match;
    match.source_m = {x(random), y(random)};
    const std::complex<double> moved = factor * std::complex<double>(match.source_m.x(), match.source_m.y());
    match.target_m = {moved.real() + 0.1 + noise(random), moved.imag() - 0.05 + noise(random)};
    match.source_angle_rad = angle(random);
    match.target_angle_rad = WrapAngle(match.source_angle_rad + std::arg(factor));
    if (i >= right) {
      match.target_m = {x(random), y(random)};
      match.target_angle_rad = angle(random);
    }
    matches.push_back(match);
  }
  return matches;
}

class ScaleOfTwoViews : public ::testing::TestWithParam<double> {};

TEST_P(ScaleOfTwoViews, IsFoundAmongWrongMatches) {
  const auto found = FitSimilarity(Matches(40, 160, std::polar(GetParam(), 0.7)), kAreaM2, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale(), GetParam(), 0.002 * GetParam());
  EXPECT_NEAR(std::arg(found->factor), 0.7, 0.002);
  EXPECT_GE(found->inliers.size(), 39U);
  EXPECT_NEAR((*found * Eigen::Vector2d(0.0, 0.0) - Eigen::Vector2d(0.1, -0.05)).norm(), 0.0, 3e-4);
  EXPECT_LT(found->log_sigma, 0.002);
}
INSTANTIATE_TEST_SUITE_P(Scales, ScaleOfTwoViews, ::testing::Values(0.4, 0.8, 1.0, 1.25, 2.5));

TEST(ScaleRegistration, FindsNothingWhereNothingIsShared) {
  EXPECT_FALSE(FitSimilarity(Matches(0, 300, 1.0), kAreaM2, {}));
  EXPECT_FALSE(FitSimilarity(Matches(5, 0, 1.0), kAreaM2, {})) << "too few";
}

TEST(ScaleRegistration, LooksNoFartherThanTheLargestScale) {
  ScaleRegistrationOptions narrow;
  narrow.max_scale = 1.5;
  EXPECT_FALSE(FitSimilarity(Matches(100, 0, 2.0), kAreaM2, narrow));
}

TEST(ScaleRegistration, OptionsAreChecked) {
  OptionTable<ScaleRegistrationOptions>()
      .Refuses("resolution_m", &ScaleRegistrationOptions::resolution_m, {0.0, 1.0})
      .Refuses("inlier_radius_px", &ScaleRegistrationOptions::inlier_radius_px, {0.0})
      .Refuses("max_ratio", &ScaleRegistrationOptions::max_ratio, {0.0F, 1.1F})
      .Refuses("max_scale", &ScaleRegistrationOptions::max_scale, {1.0})
      .Refuses("iterations", &ScaleRegistrationOptions::iterations, {0})
      .Refuses("min_inliers", &ScaleRegistrationOptions::min_inliers, {2})
      .Refuses("max_p_wrong", &ScaleRegistrationOptions::max_p_wrong, {0.0, 1.0})
      .Refuses("min_log_sigma", &ScaleRegistrationOptions::min_log_sigma, {0.0})
      .RefusesBadRun();
}

}  // namespace
}  // namespace floorloc
