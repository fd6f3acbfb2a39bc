// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace floorloc {
namespace {

constexpr double kNormal975 = 1.959963984540054;  // 97.5 % quantile of the normal distribution

// Wilson and Hilferty: the cube root of a chi-square variable over its degrees of freedom is nearly normal. Accurate to
// 1 % from ten degrees of freedom on.
double ChiSquareQuantile(double degrees_of_freedom, double normal_quantile) {
  const double variance = 2.0 / (9.0 * degrees_of_freedom);
  const double root = std::max(0.0, 1.0 - variance + normal_quantile * std::sqrt(variance));
  return degrees_of_freedom * root * root * root;
}

int DecadeOf(double probability, int decades) {
  if (!(probability > 0.0)) {
    return decades - 1;
  }
  return std::clamp(static_cast<int>(std::floor(-std::log10(probability))), 0, decades - 1);
}

}  // namespace

double Nees(const Pose2& truth, const Pose2& estimate, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d error(estimate.x() - truth.x(), estimate.y() - truth.y(),
                              WrapAngle(estimate.yaw() - truth.yaw()));
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) {
    return std::numeric_limits<double>::infinity();
  }
  return error.dot(factor.solve(error));
}

NeesSummary SummarizeNees(const std::vector<double>& values, int degrees_of_freedom) {
  assert(degrees_of_freedom > 0);
  if (values.empty()) {
    return {};
  }
  const auto n = static_cast<double>(values.size());
  const double total = n * degrees_of_freedom;
  return {values.size(), std::accumulate(values.begin(), values.end(), 0.0) / n,
          ChiSquareQuantile(total, -kNormal975) / n, ChiSquareQuantile(total, kNormal975) / n};
}

ObservedRate EstimateRate(std::size_t events, std::size_t of) {
  assert(events <= of);
  if (of == 0) {
    return {};
  }
  const auto n = static_cast<double>(of);
  const double rate = static_cast<double>(events) / n;
  const double z2 = kNormal975 * kNormal975;
  const double middle = (rate + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kNormal975 * std::sqrt(rate * (1.0 - rate) / n + z2 / (4.0 * n * n)) / (1.0 + z2 / n);
  return {rate, events == 0 ? 0.0 : middle - half, events == of ? 1.0 : middle + half};
}

std::vector<ReliabilityBin> BinByDecade(const std::vector<Forecast>& forecasts, int decades) {
  assert(decades > 0);
  std::vector<ReliabilityBin> bins(static_cast<std::size_t>(decades));
  for (int i = 0; i < decades; ++i) {
    ReliabilityBin& bin = bins[static_cast<std::size_t>(i)];
    bin.upper = std::pow(10.0, -i);
    bin.lower = i + 1 == decades ? 0.0 : std::pow(10.0, -i - 1);
  }
  for (const Forecast& forecast : forecasts) {
    ReliabilityBin& bin = bins[static_cast<std::size_t>(DecadeOf(forecast.probability, decades))];
    ++bin.count;
    bin.events += forecast.occurred;
    bin.predicted += forecast.probability;
  }
  for (ReliabilityBin& bin : bins) {
    bin.predicted /= std::max<double>(1.0, static_cast<double>(bin.count));
    bin.observed = EstimateRate(bin.events, bin.count);
  }
  return bins;
}

}  // namespace floorloc
