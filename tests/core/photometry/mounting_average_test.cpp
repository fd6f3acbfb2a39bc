// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/mounting_average.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/geometry/mounting.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

constexpr double kSlopePerM = 3e4;  // grey levels
constexpr double kNoise = 30.0;     // grey levels
constexpr int kCells = 60;
constexpr int kCellPixels = 60;
constexpr double kStrongLevel = 4e-3;
constexpr double kTypicalPx = 0.3;

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

// Frames whose calibration is a little wrong, too: the modes of a real camera are in the problem.
class MiscalibratedMountingTest : public MountingAverageTest {
 protected:
  using CalibrationVector = Eigen::Matrix<double, kCalibrationModes, 1>;

  MiscalibratedMountingTest() {
    const FloorCamera camera = MakeDownwardCamera();
    const CalibrationModes modes(camera);
    const Eigen::Vector3d center = camera.CameraCenter();
    for (int i = 0; i < kCells * kCellPixels; ++i) {
      const Eigen::Vector2d arm(Uniform(0.15), Uniform(0.2));
      const Eigen::Vector2d point = center.head<2>() + arm;
      Pixel pixel;
      pixel.motions << 1.0, 0.0, -arm.y(), MountingJacobian(center, point).row(0), 0.0, 1.0, arm.x(),
          MountingJacobian(center, point).row(1);
      pixel.modes = modes.At(point);
      pixels_.push_back(pixel);
    }
  }

  // sigma_px: of the corner of the region of interest, all modes together; their squares add up to 5.9 there.
  CalibrationVector RandomLens(double sigma_px) {
    return CalibrationVector::NullaryExpr([&](Eigen::Index) { return Normal(sigma_px / std::sqrt(5.9)); });
  }

  MountingProblem PoseWith(const MountingVector& truth, const CalibrationVector& lens) {
    MountingProblem problem;
    problem.variance = kNoise * kNoise;
    for (const Pixel& pixel : pixels_) {
      const Eigen::RowVector2d slope(Normal(kSlopePerM), Normal(kSlopePerM));
      const Eigen::Matrix<double, 1, 7> row = slope * pixel.motions;
      const Eigen::Matrix<double, 1, kCalibrationModes> bend = slope * pixel.modes;
      const double residual = row.dot(truth) + bend.dot(lens) + Normal(kNoise);
      problem.information += row.transpose() * row;
      problem.gradient += residual * row.transpose();
      problem.by_calibration += row.transpose() * bend;
      problem.calibration_information += bend.transpose() * bend;
      problem.calibration_gradient += residual * bend.transpose();
    }
    problem.scatter = problem.variance * problem.information;
    return problem;
  }

  double MeanMotionNees(double level, double lens_px, double calibration_sigma_px) {
    constexpr int kRounds = 200;
    double sum = 0.0;
    for (int round = 0; round < kRounds; ++round) {
      const MountingVector truth = RandomTruth(level);
      const MountingProblem problem = PoseWith(truth, RandomLens(lens_px));
      const MountingEstimate estimate = MarginalizeMounting(problem, MountingVector::Zero(), calibration_sigma_px);
      const Eigen::Vector3d error = (estimate.mean - truth).head<3>();
      sum += error.dot(estimate.covariance.topLeftCorner<3, 3>().ldlt().solve(error));
    }
    return sum / kRounds;
  }

 private:
  struct Pixel {
    Eigen::Matrix<double, 2, 7> motions;
    CalibrationJacobian modes;
  };
  std::vector<Pixel> pixels_;
};

MountingProblem WithoutModes(MountingProblem problem) {
  const MountingProblem none;
  problem.by_calibration = none.by_calibration;
  problem.calibration_information = none.calibration_information;
  problem.calibration_gradient = none.calibration_gradient;
  return problem;
}

TEST_F(MiscalibratedMountingTest, ABentLensIsNotTakenForATilt) {
  constexpr int kRounds = 50;
  double square = 0.0, square_if_exact = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const MountingProblem problem = PoseWith(MountingVector::Zero(), RandomLens(kTypicalPx));
    const MountingEstimate estimate = MarginalizeMounting(problem, MountingVector::Zero(), kTypicalPx);
    ExpectProper(estimate);
    square += estimate.mean.head<2>().squaredNorm() / kRounds;
    square_if_exact += MarginalizeMounting(problem, MountingVector::Zero()).mean.head<2>().squaredNorm() / kRounds;
  }
  EXPECT_LT(std::sqrt(square), 2e-4);
  EXPECT_LT(std::sqrt(square), 0.6 * std::sqrt(square_if_exact));
}

TEST_F(MiscalibratedMountingTest, CovarianceIsHonestWithBentLensesAndVibration) {
  for (const double lens_px : {0.0, 0.1, kTypicalPx, 0.6, 1.0}) {
    for (const double level : {1e-3, kStrongLevel}) {
      const double nees = MeanMotionNees(level, lens_px, kTypicalPx);
      EXPECT_GT(nees, 1.5) << "lens " << lens_px << " px, level " << level;
      EXPECT_LT(nees, 6.0) << "lens " << lens_px << " px, level " << level;
    }
    EXPECT_LT(MeanMotionNees(0.0, lens_px, kTypicalPx), 3.0) << "still, lens " << lens_px << " px";
  }
  EXPECT_GT(MeanMotionNees(1e-3, 0.6, 0.0), 9.0) << "a bent lens that is taken as exact";
}

TEST_F(MiscalibratedMountingTest, ATrueTiltIsAbsorbedAllTheSame) {
  constexpr int kRounds = 50;
  MountingVector truth = MountingVector::Zero();
  truth(3) = 0.5 * std::numbers::pi / 180.0;
  MountingVector squares = MountingVector::Zero();
  for (int round = 0; round < kRounds; ++round) {
    const MountingProblem problem = PoseWith(truth, CalibrationVector::Zero());
    const MountingEstimate estimate = MarginalizeMounting(problem, MountingVector::Zero(), kTypicalPx);
    squares += (estimate.mean - truth).cwiseAbs2() / kRounds;
  }
  const MountingVector error = squares.cwiseSqrt();
  EXPECT_LT(error(3), 1e-3);
  EXPECT_LT(error.head<2>().maxCoeff(), 3.5e-4) << "the tilt alone moves the view by 3.5 mm";
}

TEST_F(MiscalibratedMountingTest, AnExactCalibrationNeedsNoModes) {
  const MountingProblem problem = PoseWith(RandomTruth(1e-3), RandomLens(kTypicalPx));
  const MountingVector unknowns = RandomTruth(1e-3);
  const MountingEstimate exact = MarginalizeMounting(problem, unknowns, 0.0);
  const MountingEstimate without = MarginalizeMounting(WithoutModes(problem), unknowns, 0.0);
  EXPECT_LT((exact.mean - without.mean).norm(), 1e-9);
  EXPECT_LT((exact.covariance - without.covariance).norm(), 1e-6 * without.covariance.norm());
}

TEST_F(MiscalibratedMountingTest, WithoutModesInTheProblemTheCalibrationDoesNotMatter) {
  const MountingProblem problem = WithoutModes(PoseWith(RandomTruth(1e-3), RandomLens(kTypicalPx)));
  const MountingVector unknowns = RandomTruth(1e-3);
  const MountingEstimate exact = MarginalizeMounting(problem, unknowns, 0.0);
  for (const double sigma_px : {0.1, 1.0, 5.0}) {
    const MountingEstimate estimate = MarginalizeMounting(problem, unknowns, sigma_px);
    EXPECT_LT((estimate.mean - exact.mean).norm(), 1e-9) << sigma_px;
    EXPECT_LT((estimate.covariance - exact.covariance).norm(), 1e-6 * exact.covariance.norm()) << sigma_px;
  }
}

}  // namespace
}  // namespace floorloc
