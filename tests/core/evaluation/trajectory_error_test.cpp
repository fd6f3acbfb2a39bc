// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace floorloc {
namespace {

PosePair Pair(std::int64_t stamp_ns, const Pose2& reference, const Pose2& estimate) {
  return {StampedPose3::FromPose2(stamp_ns, reference), StampedPose3::FromPose2(stamp_ns + 1, estimate)};
}

TEST(AbsolutePoseErrors, ByHand) {
  const auto errors = AbsolutePoseErrors({Pair(10, {1, 2, 0.5}, {4, 6, 0.5}), Pair(20, {0, 0, 3.0}, {0, 0, -3.0}),
                                          Pair(30, {1, 1, 0}, {1, 1, std::numbers::pi / 2})});
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_EQ(errors[0].stamp_ns, 11);
  EXPECT_NEAR(errors[0].translation_m, 5.0, 1e-12);
  EXPECT_NEAR(errors[0].rotation_rad, 0.0, 1e-7);
  EXPECT_NEAR(errors[0].full, 5.0, 1e-12);
  EXPECT_NEAR(errors[1].translation_m, 0.0, 1e-12);
  EXPECT_NEAR(errors[1].rotation_rad, 2 * std::numbers::pi - 6.0, 1e-12);
  // Rotation by 90 degrees: R - I = [-1 -1; 1 -1].
  EXPECT_NEAR(errors[2].full, 2.0, 1e-12);
  EXPECT_NEAR(errors[2].rotation_rad, std::numbers::pi / 2, 1e-12);
}

TEST(AbsolutePoseErrors, CountsHeightAndTilt) {
  PosePair pair = Pair(0, {0, 0, 0}, {0, 0, 0});
  pair.estimate.translation_m.z() = 2.0;
  pair.estimate.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX());
  const auto errors = AbsolutePoseErrors({pair});
  EXPECT_NEAR(errors[0].translation_m, 2.0, 1e-12);
  EXPECT_NEAR(errors[0].rotation_rad, 0.3, 1e-12);
}

// The reference moves in 1 m steps along x; the estimate in 1.1 m steps, in a rotated and distant frame.
std::vector<PosePair> Drive(int count) {
  const Pose2 other_frame(100, -50, 2.0);
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back(Pair(i, {1.0 * i, 0, 0}, other_frame * Pose2(1.1 * i, 0, 0.01 * i)));
  }
  return pairs;
}

TEST(RelativePoseErrors, ComparesMotionsWhateverTheFrame) {
  const auto errors = RelativePoseErrors(Drive(2), {{0, 1}});
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_NEAR(errors[0].translation_m, 0.1, 1e-12);
  EXPECT_NEAR(errors[0].rotation_rad, 0.01, 1e-12);
  EXPECT_EQ(errors[0].stamp_ns, 2);
}

TEST(RelativePoseErrors, AreOfTheMotionsAskedFor) {
  const auto errors = RelativePoseErrors(Drive(7), {{0, 2}, {1, 6}});
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_NEAR(errors[0].translation_m, 0.2, 1e-12);
  EXPECT_EQ(errors[1].stamp_ns, 7);
  EXPECT_NEAR(errors[1].rotation_rad, 0.05, 1e-12);
  EXPECT_TRUE(RelativePoseErrors(Drive(7), {}).empty());
}

TEST(Summarize, ByHand) {
  const ErrorStatistics s = Summarize({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.sse, 30);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.p99, 3.97);
}

TEST(Summarize, OddCountAndSingleValue) {
  EXPECT_DOUBLE_EQ(Summarize({9, 1, 5}).median, 5);
  const ErrorStatistics s = Summarize({7});
  EXPECT_DOUBLE_EQ(s.median, 7);
  EXPECT_DOUBLE_EQ(s.p99, 7);
  EXPECT_DOUBLE_EQ(s.std, 0);
  EXPECT_THROW(Summarize({}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
