// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/filter_state.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace floorloc {

Eigen::Matrix3d FilterState::MapCovariance() const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = map_from_base.rotation();
  return turn * covariance.topLeftCorner<3, 3>() * turn.transpose();
}

void FilterState::Add(const ErrorVector& error) {
  map_from_base = map_from_base * Pose2::Exp(error.head<3>());
  velocity_m_s += error.segment<2>(error_row::kVelocity);
  imu_bias.yaw_rate_rad_s += error(error_row::kGyroBias);
  imu_bias.acceleration_m_s2 += error.segment<2>(error_row::kAccelerationBias);
  odometry_bias.scale += error(error_row::kOdometryScale);
  odometry_bias.yaw_scale += error(error_row::kOdometryYawScale);
  odometry_bias.drift_rad_per_m += error(error_row::kOdometryDrift);
  vision_scale += error(error_row::kVisionScale);
  fix_bias += error.segment<3>(error_row::kFixBias);
  visual_map_from_base = visual_map_from_base * Pose2::Exp(error.segment<3>(error_row::kVisual));
}

Eigen::Matrix3d ToBaseFrame(const Eigen::Matrix3d& additive, const Pose2& pose) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = pose.rotation().transpose();
  return turn * additive * turn.transpose();
}

Eigen::Vector3d FixBiasVariance(const SharedFixNoise& noise) {
  return Eigen::Vector3d(noise.sigma_m, noise.sigma_m, noise.sigma_rad).cwiseAbs2();
}

double AdaptNoiseFactor(double factor, double mahalanobis_squared, const NoiseAdaptation& adaptation) {
  constexpr double kExpected = 3.0;
  constexpr double kMaxExcess = 4.0;  // limits the effect of a single outlier
  const double excess = std::min(mahalanobis_squared / kExpected, kMaxExcess) - 1.0;
  return std::clamp(factor * std::exp(adaptation.rate * excess), adaptation.min_factor, adaptation.max_factor);
}

double LargestSigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues().maxCoeff());
}

}  // namespace floorloc
