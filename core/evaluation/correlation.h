// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace floorloc {

/// Linear correlation of two quantities.
struct Correlation {
  double r = 0.0;  ///< Pearson's coefficient, -1 to 1
  /// Probability of an |r| at least as large if the two were independent and normally distributed (two-sided t-test
  /// with samples - 2 degrees of freedom).
  double p = 1.0;
  std::size_t samples = 0;
};

/// Correlation of pairs (x[i], y[i]); x and y have equal length. Empty for fewer than three samples and when one of the
/// two is constant.
std::optional<Correlation> PearsonCorrelation(const std::vector<double>& x, const std::vector<double>& y);

/// Regularized incomplete beta function I_x(a, b); a, b > 0, 0 <= x <= 1.
double IncompleteBeta(double a, double b, double x);

}  // namespace floorloc
