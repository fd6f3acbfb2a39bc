// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/learnt_values.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

namespace floorloc {
namespace {

// Symmetric, positive definite, no two elements alike.
template <typename Matrix>
Matrix Spread() {
  Matrix root;
  double number = 0.1;
  for (double& element : root.reshaped()) {
    element = number;
    number = 1.7 - 1.1 * number * number;
  }
  const Matrix square = root * root.transpose();
  return 0.5 * (square + square.transpose());  // to the last bit
}

LearntValues Everything() {
  LearntValues learnt;
  learnt.odometry = LearntOdometry{{0.05, -0.02, 0.003}, 1e-4 * Spread<Eigen::Matrix3d>(), 2.5, 96'000'000};
  learnt.camera.all = {1e4 * Spread<CameraErrorMatrix>(), Spread<CameraErrorMatrix>().col(3)};
  learnt.camera.recent = {Spread<CameraErrorMatrix>(), CameraErrors::Constant(-0.5)};
  learnt.camera.camera = 0xFEDCBA9876543210U;
  learnt.camera.fixes = 123;
  learnt.camera.last_used = Pose2(1.5, -20.25, 3.0);
  learnt.readout = {{0.0201, 5e-4}, {-0.0199, 6e-4}};
  learnt.mask = {{3, 2}, {0.25, 0.125, 1e-3, 320, 240}, {}, 41, 0.125};
  learnt.mask.votes = {(cv::Mat_<float>(2, 3) << 30, 31, 32, 33, 34, 35), (cv::Mat_<float>(2, 3) << 0, 1, 2, 33, 4, 5),
                       (cv::Mat_<float>(2, 3) << 29.5, 9, 8, 0, 6, 5)};
  return learnt;
}

void ExpectSame(const LearntValues& a, const LearntValues& b) {
  ASSERT_EQ(a.odometry.has_value(), b.odometry.has_value());
  if (a.odometry) {
    EXPECT_EQ(a.odometry->bias.scale, b.odometry->bias.scale);
    EXPECT_EQ(a.odometry->bias.yaw_scale, b.odometry->bias.yaw_scale);
    EXPECT_EQ(a.odometry->bias.drift_rad_per_m, b.odometry->bias.drift_rad_per_m);
    EXPECT_EQ(a.odometry->covariance, b.odometry->covariance);
    EXPECT_EQ(a.odometry->noise_factor, b.odometry->noise_factor);
    EXPECT_EQ(a.odometry->offset_ns, b.odometry->offset_ns);
  }
  EXPECT_EQ(a.camera.all.information, b.camera.all.information);
  EXPECT_EQ(a.camera.all.pull, b.camera.all.pull);
  EXPECT_EQ(a.camera.recent.information, b.camera.recent.information);
  EXPECT_EQ(a.camera.recent.pull, b.camera.recent.pull);
  EXPECT_EQ(a.camera.camera, b.camera.camera);
  EXPECT_EQ(a.camera.fixes, b.camera.fixes);
  ASSERT_EQ(a.camera.last_used.has_value(), b.camera.last_used.has_value());
  EXPECT_TRUE(!a.camera.last_used || a.camera.last_used->Between(*b.camera.last_used).Log().norm() == 0.0);
  ASSERT_EQ(a.readout.size(), b.readout.size());
  for (std::size_t i = 0; i < a.readout.size(); ++i) {
    EXPECT_EQ(a.readout[i].seconds, b.readout[i].seconds);
    EXPECT_EQ(a.readout[i].sigma_s, b.readout[i].sigma_s);
  }
  EXPECT_EQ(a.mask.cells, b.mask.cells);
  EXPECT_EQ(a.mask.grid.x_top_m, b.mask.grid.x_top_m);
  EXPECT_EQ(a.mask.grid.y_left_m, b.mask.grid.y_left_m);
  EXPECT_EQ(a.mask.grid.resolution_m, b.mask.grid.resolution_m);
  EXPECT_EQ(a.mask.pairs, b.mask.pairs);
  EXPECT_EQ(a.mask.share, b.mask.share);
  EXPECT_EQ(cv::norm(a.mask.votes.views, b.mask.votes.views), 0.0);
  EXPECT_EQ(cv::norm(a.mask.votes.standing, b.mask.votes.standing), 0.0);
  EXPECT_EQ(cv::norm(a.mask.votes.floor, b.mask.votes.floor), 0.0);
}

TEST(LearntValuesTest, NumbersTellAllOfThem) {
  const std::vector<double> numbers = ToNumbers(Everything());
  const auto read = FromNumbers(numbers);
  ASSERT_TRUE(read);
  ExpectSame(*read, Everything());
  EXPECT_EQ(ToNumbers(*read), numbers);
}

TEST(LearntValuesTest, NothingWasLearntYet) {
  const auto read = FromNumbers(ToNumbers({}));
  ASSERT_TRUE(read);
  ExpectSame(*read, {});
}

TEST(LearntValuesTest, OtherNumbersAreRefused) {
  const std::vector<double> numbers = ToNumbers(Everything());
  std::vector<double> other = numbers;
  other[0] += 1.0;
  EXPECT_FALSE(FromNumbers(other)) << "another format";
  for (std::size_t count = 0; count < numbers.size(); ++count) {
    EXPECT_FALSE(FromNumbers({numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count)})) << count;
  }
  other = numbers;
  other.push_back(0.0);
  EXPECT_FALSE(FromNumbers(other)) << "one too many";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const double wrong :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
      other = numbers;
      other[i] = wrong;
      EXPECT_FALSE(FromNumbers(other)) << i << ": " << wrong;
    }
  }
}

TEST(LearntValuesTest, ACovarianceThatIsNoneIsRefused) {
  LearntValues learnt = Everything();
  learnt.odometry->covariance(1, 1) *= -1.0;
  EXPECT_FALSE(FromNumbers(ToNumbers(learnt)));
  learnt = Everything();
  learnt.camera.all.information(2, 2) = -1.0;
  EXPECT_FALSE(FromNumbers(ToNumbers(learnt)));
}

TEST(LearntValuesTest, WhatFixesTaughtHoldsForOneCalibrationTheMaskForOneView) {
  const LearntWith before{1, 2};
  ExpectSame(HeldWith({1, 2}, Everything(), before), Everything());
  const LearntValues corrected = HeldWith({1, 3}, Everything(), before);
  EXPECT_FALSE(corrected.odometry);
  EXPECT_EQ(corrected.camera.fixes, 0);
  EXPECT_TRUE(corrected.readout.empty());
  EXPECT_EQ(corrected.mask.pairs, 41);
  EXPECT_EQ(HeldWith({2, 2}, Everything(), before).mask.pairs, 0);
  EXPECT_TRUE(HeldWith({2, 2}, Everything(), before).odometry);
  ExpectSame(HeldWith({2, 3}, Everything(), before), {});
}

}  // namespace
}  // namespace floorloc
