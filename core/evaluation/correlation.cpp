// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/correlation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace floorloc {
namespace {

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Coefficient number n >= 1 of the continued fraction of I_x(a, b): NIST Digital Library of Mathematical Functions,
// 8.17.22 and 8.17.23.
double BetaCoefficient(double a, double b, double x, int n) {
  const int half = n / 2;
  const double m = half;
  if (n % 2 == 0) {
    return m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
  }
  return -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
}

// 1 / (1 + d1 / (1 + d2 / (1 + ...))) by Lentz's method as modified by Thompson and Barnett (1986): iterates the ratios
// of successive numerators and denominators until convergence.
double BetaFraction(double a, double b, double x) {
  constexpr int kMaxSteps = 10'000;
  constexpr double kTiny = 1e-300;
  double numerators = 1.0;
  double denominators = 0.0;
  double value = 1.0;
  for (int n = 1; n <= kMaxSteps; ++n) {
    const double d = BetaCoefficient(a, b, x, n);
    const double denominator = 1.0 + d * denominators;
    denominators = 1.0 / (std::abs(denominator) < kTiny ? kTiny : denominator);
    const double numerator = 1.0 + d / numerators;
    numerators = std::abs(numerator) < kTiny ? kTiny : numerator;
    const double step = numerators * denominators;
    value *= step;
    if (std::abs(step - 1.0) < std::numeric_limits<double>::epsilon()) {
      break;
    }
  }
  return 1.0 / value;
}

}  // namespace

double IncompleteBeta(double a, double b, double x) {
  assert(a > 0.0 && b > 0.0 && x >= 0.0 && x <= 1.0);
  if (x == 0.0 || x == 1.0) {
    return x;
  }
  if (x > (a + 1.0) / (a + b + 2.0)) {  // there the fraction converges slowly
    return 1.0 - IncompleteBeta(b, a, 1.0 - x);
  }
  const double log_beta = std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
  const double front = std::exp(a * std::log(x) + b * std::log1p(-x) - log_beta) / a;
  return front * BetaFraction(a, b, x);
}

std::optional<Correlation> PearsonCorrelation(const std::vector<double>& x, const std::vector<double>& y) {
  assert(x.size() == y.size());
  if (x.size() < 3) {
    return std::nullopt;
  }
  const double mean_x = Mean(x);
  const double mean_y = Mean(y);
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (!(xx > 0.0) || !(yy > 0.0)) {
    return std::nullopt;
  }
  Correlation result;
  result.samples = x.size();
  result.r = std::clamp(xy / std::sqrt(xx * yy), -1.0, 1.0);
  // With t^2 = f r^2 / (1 - r^2) and f degrees of freedom, the two-sided p value is I_{f / (f + t^2)}(f / 2, 1 / 2).
  const double freedom = static_cast<double>(x.size()) - 2.0;
  result.p = IncompleteBeta(0.5 * freedom, 0.5, 1.0 - result.r * result.r);
  return result;
}

}  // namespace floorloc
