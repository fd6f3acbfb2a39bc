// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/readout_estimator.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

ReadoutEstimator After(int images, double seconds, double sigma_s = 5e-4) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, sigma_s);
  ReadoutEstimator estimator;
  for (int i = 0; i < images; ++i) {
    estimator.Add({seconds + noise(random), sigma_s});
  }
  return estimator;
}

TEST(ReadoutEstimatorTest, SaysNothingBeforeItHasSeenEnough) {
  EXPECT_FALSE(After(ReadoutEstimatorOptions().min_images - 1, 0.02).Estimate());
  EXPECT_TRUE(After(ReadoutEstimatorOptions().min_images, 0.02).Estimate());
}

TEST(ReadoutEstimatorTest, AveragesManyImages) {
  const auto estimate = After(40, 0.02).Estimate();
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->seconds, 0.02, 3e-4);
  EXPECT_LT(estimate->sigma_s, 4e-4);
}

TEST(ReadoutEstimatorTest, AFewWrongImagesDoNotMoveIt) {
  ReadoutEstimator estimator = After(12, 0.02);
  for (int i = 0; i < 4; ++i) {
    estimator.Add({-0.03, 5e-4});
  }
  ASSERT_TRUE(estimator.Estimate());
  EXPECT_NEAR(estimator.Estimate()->seconds, 0.02, 1e-3);
}

TEST(ReadoutEstimatorTest, ImagesThatDisagreeTellNothing) {
  ReadoutEstimator estimator;
  for (int i = 0; i < 12; ++i) {
    estimator.Add({0.02 * (i - 6), 5e-4});
  }
  EXPECT_FALSE(estimator.Estimate());
}

TEST(ReadoutEstimatorTest, NearlyNoReadoutIsAGlobalShutter) {
  const auto estimate = After(20, 1e-4).Estimate();
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->seconds, 0.0);
}

TEST(ReadoutEstimatorTest, EachBadOptionIsRefusedByName) {
  OptionTable<ReadoutEstimatorOptions>()
      .Refuses("min_images", &ReadoutEstimatorOptions::min_images, {1})
      .Refuses("max_sigma_s", &ReadoutEstimatorOptions::max_sigma_s, {0.0})
      .Refuses("global_sigmas", &ReadoutEstimatorOptions::global_sigmas, {-1.0})
      .Refuses("global_s", &ReadoutEstimatorOptions::global_s, {-1.0})
      .Refuses("max_images", &ReadoutEstimatorOptions::max_images, {3});
}

}  // namespace
}  // namespace floorloc
