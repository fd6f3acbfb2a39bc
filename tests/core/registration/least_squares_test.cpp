// SPDX-License-Identifier: Apache-2.0
#include "core/registration/least_squares.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/core/registration/registration_test_support.h"

namespace floorloc {
namespace {

using testing_registration::MatchGenerator;

std::vector<int> All(const std::vector<OrientedMatch>& matches) {
  std::vector<int> all(matches.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

double SumOfSquares(const std::vector<OrientedMatch>& matches, const Pose2& pose) {
  double sum = 0.0;
  for (const OrientedMatch& m : matches) {
    sum += (pose * m.source_m - m.target_m).squaredNorm();
  }
  return sum;
}

TEST(LeastSquaresTest, NoNeighbouringPoseFitsBetter) {
  MatchGenerator draw(1);
  for (int trial = 0; trial < 50; ++trial) {
    const auto matches = draw.Right(10, draw.RandomPose(), 2e-3);
    const auto fit = FitRigid(matches, All(matches));
    ASSERT_TRUE(fit);
    const double best = SumOfSquares(matches, *fit);
    for (const Pose2& step : {Pose2(1e-5, 0, 0), Pose2(-1e-5, 0, 0), Pose2(0, 1e-5, 0), Pose2(0, -1e-5, 0),
                              Pose2(0, 0, 1e-5), Pose2(0, 0, -1e-5)}) {
      EXPECT_GT(SumOfSquares(matches, *fit * step), best);
    }
  }
}

TEST(LeastSquaresTest, UsesTheSubsetOnly) {
  MatchGenerator draw(2);
  const Pose2 truth(1.0, 2.0, 3.0);
  auto matches = draw.Right(4, truth, 0.0);
  matches[1].target_m += Eigen::Vector2d(1.0, 1.0);
  const auto fit = FitRigid(matches, std::vector<int>{0, 2, 3});
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->translation() - truth.translation()).norm(), 1e-9);
  EXPECT_EQ(FindInliers(matches, truth, 1e-6), (std::vector<int>{0, 2, 3}));
}

TEST(LeastSquaresTest, OnePointFixesNoRotation) {
  const std::vector<OrientedMatch> same(3, OrientedMatch{{0.1, 0.2}, {1.0, 1.0}, 0.0, 0.0});
  EXPECT_FALSE(FitRigid(same, All(same)));
  EXPECT_FALSE(FitRigid(same, std::vector<int>{0}));
  EXPECT_FALSE(FitRigid(same, std::vector<int>{}));
}

TEST(LeastSquaresTest, CovarianceMatchesTheScatterOfTheFit) {
  MatchGenerator draw(3);
  const Pose2 truth(0.5, -0.5, 2.0);
  const auto clean = draw.Right(30, truth, 0.0);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto noisy = clean;
    for (OrientedMatch& m : noisy) {
      m.target_m += Eigen::Vector2d(draw.Normal(5e-4), draw.Normal(5e-4));
    }
    const Pose2 fit = FitRigid(noisy, All(noisy)).value();
    const Eigen::Vector3d error(fit.x() - truth.x(), fit.y() - truth.y(), WrapAngle(fit.yaw() - truth.yaw()));
    scatter += error * error.transpose() / kTrials;
  }
  const Eigen::Matrix3d predicted = PoseCovariance(clean, All(clean), truth, 5e-4);
  EXPECT_LT((scatter - predicted).norm(), 0.1 * predicted.norm());
}

}  // namespace
}  // namespace floorloc
