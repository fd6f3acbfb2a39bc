// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/kalman_correction.h"

#include <Eigen/Cholesky>

namespace floorloc {

double MahalanobisSquared(const Innovation& innovation, const ErrorMatrix& covariance) {
  const ErrorMatrix expected = PropagateCovariance(innovation.jacobian, covariance) + innovation.noise;
  return innovation.residual.dot(expected.ldlt().solve(innovation.residual));
}

Correction KalmanCorrection(const Innovation& innovation, const ErrorMatrix& covariance) {
  const ErrorMatrix& jacobian = innovation.jacobian;
  const ErrorMatrix jacobian_covariance = jacobian * covariance;
  const ErrorMatrix expected = jacobian_covariance * jacobian.transpose() + innovation.noise;
  const ErrorMatrix gain = expected.ldlt().solve(jacobian_covariance).transpose();
  const ErrorMatrix i_minus_kh = ErrorMatrix::Identity(covariance.rows(), covariance.cols()) - gain * jacobian;
  return {gain * innovation.residual,
          PropagateCovariance(i_minus_kh, covariance) + PropagateCovariance(gain, innovation.noise)};
}

ErrorMatrix PropagateCovariance(const ErrorMatrix& jacobian, const ErrorMatrix& covariance) {
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace floorloc
