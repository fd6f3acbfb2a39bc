// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace floorloc {

/// How two quantities go together.
struct Correlation {
  double r = 0.0;  ///< Pearson's coefficient, -1 to 1
  /// Probability of an r at least as far from 0 if the two, normally distributed, had nothing to do with each other
  /// (two-sided t-test with samples - 2 degrees of freedom).
  double p = 1.0;
  std::size_t samples = 0;
};

/// Of pairs (x[i], y[i]); x and y are equally long. Empty for fewer than three samples, and when one of the two never
/// changes.
std::optional<Correlation> PearsonCorrelation(const std::vector<double>& x, const std::vector<double>& y);

/// Regularized incomplete beta function I_x(a, b); a, b > 0, 0 <= x <= 1.
double IncompleteBeta(double a, double b, double x);

}  // namespace floorloc
