// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/deviation_range.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

constexpr double kProbability = 0.95;
constexpr int kIntervals = 64;  // even, for Simpson's rule: exact to 1e-6 of the probability
constexpr int kBisections = 30;

// Probability of |(a, b)| <= radius for independent a of N(0, 1) and b of N(0, ratio^2), 0 <= ratio <= 1: the integral
// over a = radius sin(t), in which the integrand is smooth, of P(|b| <= radius cos(t)).
double ProbabilityWithin(double radius, double ratio) {
  const auto density = [&](double t) {
    const double a = radius * std::sin(t);
    const double half = radius * std::cos(t);
    const double inside = ratio > 0.0 ? std::erf(half / (ratio * std::numbers::sqrt2)) : (half > 0.0 ? 1.0 : 0.0);
    return std::exp(-0.5 * a * a) / std::sqrt(2.0 * std::numbers::pi) * inside * half;
  };
  const double step = std::numbers::pi / 2.0 / kIntervals;
  double sum = density(0.0) + density(std::numbers::pi / 2.0);
  for (int i = 1; i < kIntervals; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * density(i * step);
  }
  return 2.0 * sum * step / 3.0;
}

}  // namespace

double DeviationRange(const std::array<double, 9>& covariance) {
  const double mean = 0.5 * (covariance[0] + covariance[4]);
  const double difference = 0.5 * (covariance[0] - covariance[4]);
  const double cross = 0.5 * (covariance[1] + covariance[3]);
  const double radius = std::hypot(difference, cross);
  const double larger = std::max(mean + radius, 0.0);
  if (larger == 0.0) {
    return 0.0;
  }
  const double ratio = std::sqrt(std::max(mean - radius, 0.0) / larger);
  double low = 1.9;
  double high = 2.5;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (ProbabilityWithin(middle, ratio) < kProbability ? low : high) = middle;
  }
  return std::sqrt(larger) * 0.5 * (low + high);
}

}  // namespace floorloc
