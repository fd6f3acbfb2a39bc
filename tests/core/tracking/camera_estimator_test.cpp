// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/camera_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace floorloc {
namespace {

constexpr double kDegree = 0.017453;
constexpr std::size_t kCamera = 7;

CameraErrors Tilted(double roll_rad, double radial_px = 0.0) {
  CameraErrors errors = CameraErrors::Zero();
  errors(0) = roll_rad;
  errors(9) = radial_px;
  return errors;
}

class CameraEstimatorTest : public ::testing::Test {
 protected:
  // Of a frame that tells the mounting to 0.2 degrees and 1 %, the modes to 0.5 px, and three of the modes not at all.
  CameraEvidence Evidence(const CameraErrors& truth) {
    CameraErrors sigma = CameraErrors::Constant(0.5);
    sigma.head<3>() << 0.2 * kDegree, 0.2 * kDegree, 0.01;
    CameraEvidence evidence;
    evidence.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    evidence.information.bottomRightCorner<3, 3>().setZero();
    CameraErrors noise;
    for (int i = 0; i < noise.size(); ++i) {
      noise(i) = sigma(i) * normal_(random_);
    }
    evidence.pull = evidence.information * (truth + noise);
    evidence.view_radius_m = 0.2;
    evidence.camera = kCamera;
    return evidence;
  }

  // Fixes of a vehicle that drives on, 0.3 m each.
  void Drive(int fixes, const CameraErrors& truth, double p_wrong = 1e-9) {
    for (int i = 0; i < fixes; ++i) {
      x_m_ += 0.3;
      estimator_.Add(Evidence(truth), Pose2(x_m_, 1.0, 0.2), p_wrong);
    }
  }

  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
  CameraEstimator estimator_;
  double x_m_ = 0.0;
};

TEST_F(CameraEstimatorTest, LearnsWhatManyFixesTell) {
  const CameraErrors truth = Tilted(1.0 * kDegree, 0.8);
  Drive(5, truth);
  EXPECT_EQ(estimator_.Estimate().status, CameraStatus::kLearning);
  EXPECT_FALSE(estimator_.PriorOfNextFrame());
  Drive(95, truth);
  const CameraEstimate estimate = estimator_.Estimate();
  EXPECT_EQ(estimate.status, CameraStatus::kCorrected);
  EXPECT_EQ(estimate.fixes, 100);
  const CameraErrors off = estimate.errors.mean - truth;
  EXPECT_LT(off.dot(estimate.errors.covariance.ldlt().solve(off)), 33.0);
  EXPECT_LT(std::abs(off(0)), 0.1 * kDegree);
  ASSERT_TRUE(estimator_.PriorOfNextFrame());
  EXPECT_EQ(estimator_.PriorOfNextFrame()->camera, kCamera);
}

TEST_F(CameraEstimatorTest, ACameraAsCalibratedIsNotCorrected) {
  Drive(200, Tilted(0.0));
  EXPECT_EQ(estimator_.Estimate().status, CameraStatus::kAsCalibrated);
  EXPECT_FALSE(estimator_.PriorOfNextFrame());
}

TEST_F(CameraEstimatorTest, WhatNoFixTellsStaysUnknown) {
  Drive(100, Tilted(1.0 * kDegree));
  const CameraErrorMatrix covariance = estimator_.Estimate().errors.covariance;
  EXPECT_LT(covariance(8, 8), 0.25 * covariance(11, 11));
  EXPECT_NEAR(std::sqrt(covariance(11, 11)), CameraEstimatorOptions().calibration_sigma_px / 2.43, 1e-6);
}

// Fixes share the errors of the map's own camera: any number of them leaves some doubt.
TEST_F(CameraEstimatorTest, ManyFixesTellNoMoreThanAFewIndependentOnes) {
  const CameraEvidence one = Evidence(Tilted(0.0));
  Drive(400, Tilted(0.0));
  const double information = estimator_.Estimate().errors.covariance.inverse()(2, 2);
  EXPECT_LT(information, (CameraEstimatorOptions().independent_fixes + 1.0) * one.information(2, 2));
  EXPECT_GT(information, 0.8 * CameraEstimatorOptions().independent_fixes * one.information(2, 2));
}

// A tilt looks like a lens with this mode: the fixes tell only their sum.
TEST_F(CameraEstimatorTest, WhatTheLensExplainsIsNoTilt) {
  CameraErrors sum = CameraErrors::Zero();
  sum(0) = 1.0 / (0.1 * kDegree);
  sum(3) = 1.0 / 0.3;
  CameraEvidence evidence;
  evidence.information = sum * sum.transpose();
  evidence.pull = 3.0 * sum;  // 0.9 px, or 0.3 degrees
  evidence.view_radius_m = 0.2;
  for (int i = 0; i < 100; ++i) {
    estimator_.Add(evidence, Pose2(0.3 * i, 1.0, 0.2), 1e-9);
  }
  const CameraEstimate estimate = estimator_.Estimate();
  EXPECT_EQ(estimate.errors.mean(0), 0.0);
  EXPECT_NEAR(estimate.errors.mean(3), 0.9, 0.2);
}

TEST_F(CameraEstimatorTest, AVehicleThatStandsStillAddsNothing) {
  for (int i = 0; i < 100; ++i) {
    estimator_.Add(Evidence(Tilted(1.0 * kDegree)), Pose2(1.0, 1.0, 0.0), 1e-9);
  }
  EXPECT_EQ(estimator_.Estimate().fixes, 1);
}

TEST_F(CameraEstimatorTest, UncertainFixesAreNotUsed) {
  Drive(100, Tilted(1.0 * kDegree), 1e-3);
  EXPECT_EQ(estimator_.Estimate().fixes, 0);
}

TEST_F(CameraEstimatorTest, ABumpStartsAnew) {
  Drive(400, Tilted(0.0));
  Drive(40, Tilted(-1.2 * kDegree));
  const CameraEstimate estimate = estimator_.Estimate();
  EXPECT_LT(estimate.fixes, 60);
  EXPECT_EQ(estimate.status, CameraStatus::kCorrected);
  EXPECT_NEAR(estimate.errors.mean(0), -1.2 * kDegree, 0.2 * kDegree);
}

TEST_F(CameraEstimatorTest, LargeErrorsAreNotCompensated) {
  Drive(50, Tilted(4.0 * kDegree));
  EXPECT_EQ(estimator_.Estimate().status, CameraStatus::kImplausible);
  EXPECT_FALSE(estimator_.PriorOfNextFrame());
}

TEST_F(CameraEstimatorTest, AnotherCalibrationStartsAnew) {
  Drive(50, Tilted(1.0 * kDegree));
  CameraEvidence other = Evidence(Tilted(0.0));
  other.camera = kCamera + 1;
  estimator_.Add(other, Pose2(0.0, 0.0, 0.0), 1e-9);
  EXPECT_EQ(estimator_.Estimate().fixes, 1);
  EXPECT_EQ(estimator_.Estimate().errors.camera, kCamera + 1);
}

}  // namespace
}  // namespace floorloc
