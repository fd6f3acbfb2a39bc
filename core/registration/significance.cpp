// SPDX-License-Identifier: Apache-2.0
#include "core/registration/significance.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// lgamma() is not thread-safe: it writes the sign to a global variable.
double LogFactorial(int n) {
  int sign = 0;
  return lgamma_r(n + 1.0, &sign);
}

double LogBinomialTerm(int n, int k, double p) {
  return LogFactorial(n) - LogFactorial(k) - LogFactorial(n - k) + k * std::log(p) + (n - k) * std::log1p(-p);
}

}  // namespace

double Log10Nfa(int matches, int inliers, double chance, double trials) {
  if (inliers <= 0) {
    return std::log10(trials);
  }
  const double p = std::clamp(chance, 1e-12, 1.0 - 1e-12);
  // The terms fall geometrically beyond the mean: sum relative to the first one.
  const double first = LogBinomialTerm(matches, inliers, p);
  double sum = 0.0;
  for (int k = inliers; k <= matches; ++k) {
    const double term = std::exp(LogBinomialTerm(matches, k, p) - first);
    sum += term;
    if (term < 1e-12 * sum) {
      break;
    }
  }
  return std::log10(trials) + std::min(0.0, (first + std::log(sum)) / std::log(10.0));
}

}  // namespace floorloc
