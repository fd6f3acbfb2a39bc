// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Normalised estimation error squared of (x, y, yaw): e^T C^-1 e, with the additive error of estimate against truth.
/// 3 on average when the covariance (m^2, m rad, rad^2) is honest; infinite when it is no covariance.
double Nees(const Pose2& truth, const Pose2& estimate, const Eigen::Matrix3d& covariance);

/// Is a covariance honest? The mean NEES of n independent estimates is, times n, chi-square distributed with n times
/// the degrees of freedom: outside of the bounds it is too large (overconfident) or too small (timid).
struct NeesSummary {
  std::size_t count = 0;
  double mean = 0.0;
  double lower = 0.0;  ///< 2.5 % quantile of the mean of an honest estimator
  double upper = 0.0;  ///< 97.5 % quantile

  bool Consistent() const { return mean >= lower && mean <= upper; }
};

/// All zero when there are no values.
NeesSummary SummarizeNees(const std::vector<double>& values, int degrees_of_freedom = 3);

/// An event that was predicted with a probability, and whether it came true.
struct Forecast {
  double probability = 0.0;
  bool occurred = false;
};

/// A share with its 95 % interval (Wilson's).
struct ObservedRate {
  double rate = 0.0;
  double lower = 0.0;
  double upper = 1.0;
};

/// of: number of trials; with none, nothing is known.
ObservedRate EstimateRate(std::size_t events, std::size_t of);

/// The forecasts between two powers of ten: lower < probability <= upper; the lowest bin takes all below it.
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
