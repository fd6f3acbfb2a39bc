// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

// Sizes are known at run time only: with fixed ones the compiler took half a minute for these few products.

inline constexpr int kMaxErrorRows = 21;  ///< of an error state
using ErrorColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxErrorRows, 1>;
using ErrorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxErrorRows, kMaxErrorRows>;

/// A measurement of an error state: residual = jacobian * error + noise, noise given by its covariance.
struct Innovation {
  ErrorColumn residual;
  ErrorMatrix jacobian;
  ErrorMatrix noise;
};

/// How far an innovation is from what its covariance allows: chi-square with as many degrees of freedom as it has rows.
double MahalanobisSquared(const Innovation& innovation, const ErrorMatrix& covariance);

/// The error that an innovation lets expect, and the covariance that is left of it.
struct Correction {
  ErrorColumn error;
  ErrorMatrix covariance;
};

/// Kalman correction of an error state; Joseph's form keeps the covariance positive.
Correction KalmanCorrection(const Innovation& innovation, const ErrorMatrix& covariance);

/// jacobian * covariance * jacobian^T, the covariance of what depends on a state by the jacobian.
ErrorMatrix PropagateCovariance(const ErrorMatrix& jacobian, const ErrorMatrix& covariance);

}  // namespace floorloc
