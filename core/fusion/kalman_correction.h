// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace floorloc {

/// How far a residual = jacobian * error + noise is from what its covariance allows: chi-square with kRows degrees of
/// freedom.
template <int kRows, int kState>
double MahalanobisSquared(const Eigen::Matrix<double, kRows, 1>& residual,
                          const Eigen::Matrix<double, kRows, kState>& jacobian,
                          const Eigen::Matrix<double, kRows, kRows>& noise,
                          const Eigen::Matrix<double, kState, kState>& covariance) {
  const Eigen::Matrix<double, kRows, kRows> innovation = jacobian * covariance * jacobian.transpose() + noise;
  return residual.dot(innovation.ldlt().solve(residual));
}

/// Correction of an error state by residual = jacobian * error + noise. Returns the expected error and replaces the
/// covariance by the one that is left; Joseph's form keeps it positive.
template <int kRows, int kState>
Eigen::Matrix<double, kState, 1> KalmanCorrection(const Eigen::Matrix<double, kRows, 1>& residual,
                                                  const Eigen::Matrix<double, kRows, kState>& jacobian,
                                                  const Eigen::Matrix<double, kRows, kRows>& noise,
                                                  Eigen::Matrix<double, kState, kState>* covariance) {
  using Covariance = Eigen::Matrix<double, kState, kState>;
  const Eigen::Matrix<double, kRows, kState> jacobian_covariance = jacobian * *covariance;
  const Eigen::Matrix<double, kRows, kRows> innovation = jacobian_covariance * jacobian.transpose() + noise;
  const Eigen::Matrix<double, kState, kRows> gain = innovation.ldlt().solve(jacobian_covariance).transpose();
  const Covariance i_minus_kh = Covariance::Identity() - gain * jacobian;
  *covariance = (i_minus_kh * *covariance * i_minus_kh.transpose() + gain * noise * gain.transpose()).eval();
  return gain * residual;
}

}  // namespace floorloc
