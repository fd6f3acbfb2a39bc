// SPDX-License-Identifier: Apache-2.0
#include "core/localization/mounting_average.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/mounting.h"

namespace floorloc {
namespace {

constexpr double kSlopePerM = 3e4;  // grey levels
constexpr double kNoise = 30.0;     // grey levels
constexpr int kCells = 60;
constexpr int kCellPixels = 60;
constexpr double kStrongLevel = 4e-3;

// Frames of a downward camera, as the linear least-squares problem of their pixels.
class MountingAverageTest : public ::testing::Test {
 protected:
  double Normal(double sigma) { return sigma * std::normal_distribution<double>()(rng_); }
  double Uniform(double half) { return std::uniform_real_distribution<double>(-half, half)(rng_); }

  MountingVector RandomTruth(double level) {
    MountingVector truth;
    truth << Normal(5e-4), Normal(5e-4), Normal(2e-3), Normal(level), Normal(level), Normal(level), Normal(level);
    return truth;
  }

  // Jacobian of one pixel's grey level (1x7); the frame's centre is below the camera.
  Eigen::Matrix<double, 1, 7> RandomRow() {
    const Eigen::Vector3d camera(0.2, 0.0, 0.4);
    const Eigen::Vector2d arm(Uniform(0.15), Uniform(0.2));
    Eigen::Matrix<double, 2, 7> moves;
    moves << 1.0, 0.0, -arm.y(), Eigen::RowVector4d::Zero(), 0.0, 1.0, arm.x(), Eigen::RowVector4d::Zero();
    moves.rightCols<4>() = MountingJacobian(camera, camera.head<2>() + arm);
    return Eigen::RowVector2d(Normal(kSlopePerM), Normal(kSlopePerM)) * moves;
  }

  // The problem linearized at `unknowns`.
  MountingProblem Pose(const MountingVector& truth, const MountingVector& unknowns) {
    MountingProblem problem;
    problem.variance = kNoise * kNoise;
    for (int cell = 0; cell < kCells; ++cell) {
      MountingVector pull = MountingVector::Zero();
      for (int i = 0; i < kCellPixels; ++i) {
        const Eigen::Matrix<double, 1, 7> row = RandomRow();
        problem.information += row.transpose() * row;
        pull += row.transpose() * (row * (truth - unknowns) + Normal(kNoise));
      }
      problem.gradient += pull;
    }
    // The value at convergence.
    problem.scatter = problem.variance * problem.information;
    return problem;
  }
  MountingProblem Pose(const MountingVector& truth) { return Pose(truth, MountingVector::Zero()); }

  std::vector<MountingEstimate> Estimate(const MountingVector& truth, int rounds) {
    std::vector<MountingEstimate> estimates;
    for (int round = 0; round < rounds; ++round) {
      estimates.push_back(MarginalizeMounting(Pose(truth), MountingVector::Zero()));
    }
    return estimates;
  }

  std::mt19937_64 rng_{9};
};

double Sigma(const MountingEstimate& estimate, int i) { return std::sqrt(estimate.covariance(i, i)); }

double MeanNees(const std::vector<MountingEstimate>& estimates, const std::vector<MountingVector>& truths) {
  double sum = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const MountingVector error = estimates[i].mean - truths[i];
    sum += error.dot(estimates[i].covariance.ldlt().solve(error));
  }
  return sum / static_cast<double>(estimates.size());
}

void ExpectProper(const MountingEstimate& estimate) {
  EXPECT_TRUE(estimate.mean.allFinite());
  ASSERT_TRUE(estimate.covariance.allFinite());
  const Eigen::SelfAdjointEigenSolver<MountingMatrix> eigen(estimate.covariance);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.0);
}

// RMS error of each unknown over all rounds.
MountingVector RmsError(const std::vector<MountingEstimate>& estimates, const MountingVector& truth) {
  MountingVector squares = MountingVector::Zero();
  for (const MountingEstimate& estimate : estimates) {
    squares += (estimate.mean - truth).cwiseAbs2();
  }
  return (squares / static_cast<double>(estimates.size())).cwiseSqrt();
}

MountingVector MeanSigma(const std::vector<MountingEstimate>& estimates) {
  MountingVector sum = MountingVector::Zero();
  for (const MountingEstimate& estimate : estimates) {
    sum += estimate.covariance.diagonal().cwiseSqrt();
  }
  return sum / static_cast<double>(estimates.size());
}

TEST_F(MountingAverageTest, AStillCameraStaysCalibratedAndCertain) {
  const MountingVector truth = RandomTruth(0.0);
  const std::vector<MountingEstimate> estimates = Estimate(truth, 50);
  EXPECT_LT(RmsError(estimates, truth).tail<4>().maxCoeff(), 2e-4);
  EXPECT_LT(RmsError(estimates, truth).head<2>().maxCoeff(), 1e-4);
  EXPECT_LT(MeanSigma(estimates).tail<4>().maxCoeff(), 6e-4);
  EXPECT_LT(MeanSigma(estimates).head<2>().maxCoeff(), 2e-4);
}

TEST_F(MountingAverageTest, AShakenCameraIsFollowed) {
  MountingVector truth = RandomTruth(0.0);
  truth.segment<2>(3) << 6e-3, -5e-3;
  truth(6) = 8e-3;
  const std::vector<MountingEstimate> estimates = Estimate(truth, 50);
  const MountingVector error = RmsError(estimates, truth);
  const MountingVector sigma = MeanSigma(estimates);
  for (const int i : {3, 4, 6}) {
    EXPECT_LT(error(i), 7e-4) << "unknown " << i;
    EXPECT_LT(sigma(i), 7e-4) << "unknown " << i;
  }
  EXPECT_LT(error.head<2>().maxCoeff(), 3e-4) << "a tilt alone moves the view by 2.4 mm";
}

TEST_F(MountingAverageTest, UncertaintyOfTheHeadingFollowsTheVibration) {
  const MountingEstimate calm = MarginalizeMounting(Pose(RandomTruth(0.0)), MountingVector::Zero());
  const MountingEstimate shaken = MarginalizeMounting(Pose(RandomTruth(kStrongLevel)), MountingVector::Zero());
  EXPECT_GT(Sigma(shaken, 2), 5.0 * Sigma(calm, 2));
  EXPECT_GT(Sigma(shaken, 2), 1e-3);
  // The yaw of the robot and of the camera are not separable: only their sum is observable.
  const Eigen::Vector2d both(1.0, 1.0);
  const Eigen::Matrix2d together = shaken.covariance(Eigen::seq(2, 5, 3), Eigen::seq(2, 5, 3));
  EXPECT_LT(std::sqrt(both.dot(together * both)), 0.1 * Sigma(shaken, 2));
}

TEST_F(MountingAverageTest, CovarianceIsHonestAtEveryLevel) {
  for (const double level : {3e-4, 1e-3, kStrongLevel}) {
    std::vector<MountingEstimate> estimates;
    std::vector<MountingVector> truths;
    for (int round = 0; round < 200; ++round) {
      truths.push_back(RandomTruth(level));
      estimates.push_back(MarginalizeMounting(Pose(truths.back()), MountingVector::Zero()));
    }
    const double nees = MeanNees(estimates, truths);  // 7 expected
    EXPECT_GT(nees, 4.5) << "level " << level;
    EXPECT_LT(nees, 9.0) << "level " << level;
  }
}

TEST_F(MountingAverageTest, TheAnswerDoesNotDependOnWhereTheProblemIsLinearised) {
  const MountingVector truth = RandomTruth(1e-3);
  const MountingVector elsewhere = RandomTruth(1e-3);
  rng_.seed(21);
  const MountingEstimate from_zero = MarginalizeMounting(Pose(truth), MountingVector::Zero());
  rng_.seed(21);
  const MountingEstimate from_elsewhere = MarginalizeMounting(Pose(truth, elsewhere), elsewhere);
  EXPECT_LT((from_zero.mean - from_elsewhere.mean).norm(), 1e-9);
  EXPECT_LT((from_zero.covariance - from_elsewhere.covariance).norm(), 1e-12);
}

TEST_F(MountingAverageTest, DependentPixelsMakeItLessCertain) {
  MountingProblem problem = Pose(RandomTruth(0.0));
  const double independent = Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0);
  problem.scatter *= 1e-3;
  EXPECT_NEAR(Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0), independent, 1e-12)
      << "never more certain than independent pixels";
  problem.scatter *= 25e3;
  EXPECT_GT(Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0), 1.5 * independent);
}

TEST_F(MountingAverageTest, FewCellsMakeItLessCertain) {
  MountingProblem problem = Pose(RandomTruth(0.0));
  const double sigma = Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0);
  problem.cells = 1000;
  EXPECT_NEAR(Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0), sigma, 0.01 * sigma);
  problem.cells = 9;
  EXPECT_GT(Sigma(MarginalizeMounting(problem, MountingVector::Zero()), 0), 1.5 * sigma);
}

TEST_F(MountingAverageTest, OneStepSolvesALinearProblem) {
  const MountingVector truth = RandomTruth(1e-3);
  rng_.seed(22);
  const MountingVector step = MountingStep(Pose(truth), MountingVector::Zero());
  EXPECT_LT((step - truth).head<2>().norm(), 1e-3);
  EXPECT_LT((step - truth).segment<2>(3).norm(), 2e-3);
  rng_.seed(22);
  EXPECT_LT(MountingStep(Pose(truth, step), step).norm(), 1e-9);
}

TEST_F(MountingAverageTest, WithoutInformationNothingMovesAndAllStaysFinite) {
  const MountingVector unknowns = RandomTruth(1e-3);
  EXPECT_TRUE(MountingStep({}, MountingVector::Zero()).isZero());
  EXPECT_TRUE(MountingStep({}, unknowns).allFinite());
  const MountingEstimate estimate = MarginalizeMounting({}, unknowns);
  ExpectProper(estimate);
  EXPECT_GT(Sigma(estimate, 0), 5e-3) << "nothing is known of the position";
}

TEST_F(MountingAverageTest, DegenerateProblemsStayFinite) {
  const MountingVector unknowns = RandomTruth(1e-3);
  MountingProblem one_pixel;
  const Eigen::Matrix<double, 1, 7> row = RandomRow();
  one_pixel.information = row.transpose() * row;
  one_pixel.gradient = 10.0 * row.transpose();
  one_pixel.scatter = one_pixel.gradient * one_pixel.gradient.transpose();
  MountingProblem broken = Pose(unknowns);
  broken.gradient(2) = std::numeric_limits<double>::quiet_NaN();
  MountingProblem huge = Pose(unknowns);
  huge.information *= 1e300;
  for (const MountingProblem& problem : {one_pixel, broken, huge}) {
    SCOPED_TRACE(problem.information.norm());
    EXPECT_TRUE(MountingStep(problem, unknowns).allFinite());
    ExpectProper(MarginalizeMounting(problem, unknowns));
  }
}

}  // namespace
}  // namespace floorloc
