// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Normalised estimation error squared of (x, y, yaw): e^T C^-1 e, with the additive error of estimate against truth. 3
/// on average when the covariance (m^2, m rad, rad^2) is consistent; infinite when it is not positive definite.
double Nees(const Pose2& truth, const Pose2& estimate, const Eigen::Matrix3d& covariance);

/// Consistency of covariances: n times the mean NEES of n independent estimates is chi-square distributed with n times
/// the degrees of freedom. A mean above the bounds is overconfident, below them too pessimistic.
struct NeesSummary {
  std::size_t count = 0;
  double mean = 0.0;
  double lower = 0.0;  ///< 2.5 % quantile of the mean of a consistent estimator
  double upper = 0.0;  ///< 97.5 % quantile

  bool Consistent() const { return mean >= lower && mean <= upper; }
};

/// All zero when there are no values.
NeesSummary SummarizeNees(const std::vector<double>& values, int degrees_of_freedom = 3);

/// Predicted probability of an event, and whether it occurred.
struct Forecast {
  double probability = 0.0;
  bool occurred = false;
};

/// An observed rate with its 95 % Wilson interval.
struct ObservedRate {
  double rate = 0.0;
  double lower = 0.0;
  double upper = 1.0;
};

/// of: number of trials; without any the interval is [0, 1].
ObservedRate EstimateRate(std::size_t events, std::size_t of);

/// Forecasts between two powers of ten: lower < probability <= upper; the lowest bin includes all smaller ones.
struct ReliabilityBin {
  double lower = 0.0;
  double upper = 1.0;
  std::size_t count = 0;
  std::size_t events = 0;
  double predicted = 0.0;  ///< mean of the probabilities
  ObservedRate observed;
};

/// Bins of a reliability diagram by decade, most probable first; the last one is [0, 10^-(decades - 1)].
std::vector<ReliabilityBin> BinByDecade(const std::vector<Forecast>& forecasts, int decades = 12);

}  // namespace floorloc
