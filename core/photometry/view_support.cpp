// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/view_support.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

namespace floorloc {
namespace {

constexpr int kSteps = 64;           // of the integral over the rest's agreement; the integrand is a bell of some steps
constexpr int kAreaIterations = 12;  // of expectation maximisation, which has converged to a percent then
constexpr double kMaxLog10 = 300.0;

double MeanOf(std::span<const float> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Share of the cells whose correlation is of floor that agrees (density 2 r from 0 to 1) rather than by chance (a
// Gaussian about 0).
double AgreeingShare(std::span<const float> correlations, double sigma) {
  std::vector<double> odds;  // of agreement, for equal shares
  for (const float correlation : correlations) {
    const double z = static_cast<double>(correlation) / sigma;
    const double agreeing = 2.0 * std::max(0.0, static_cast<double>(correlation));
    odds.push_back(agreeing * sigma * std::sqrt(2.0 * std::numbers::pi) * std::exp(0.5 * z * z));
  }
  double share = 0.5;
  for (int i = 0; i < kAreaIterations; ++i) {
    double sum = 0.0;
    for (const double o : odds) {
      sum += share * o / (share * o + 1.0 - share);
    }
    share = sum / static_cast<double>(odds.size());
  }
  return share;
}

// log10 of the likelihood ratio of the rest's mean correlation. By chance it is Gaussian about 0. If the pose is right,
// it is a share of that of the best cells, which tell how well this frame can agree at all: not all of it, as the best
// were chosen and some floor has changed, and not nothing (density 6 x (1 - x)).
double Log10OddsOfRest(double rest, double best, double sigma) {
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) / kSteps;
    const double off = rest - x * best;
    // Bounded, so that no term overflows; the sum is then a lower bound.
    const double exponent = std::min(0.5 * (rest * rest - off * off) / (sigma * sigma), kMaxLog10 * std::numbers::ln10);
    sum += 6.0 * x * (1.0 - x) / kSteps * std::exp(exponent);
  }
  return std::clamp(std::log10(sum), -kMaxLog10, kMaxLog10);
}

}  // namespace

double ViewSupport::LocalProbability() const { return 1.0 / (1.0 + std::pow(10.0, log10_odds)); }

ViewSupport MeasureViewSupport(std::vector<float> correlations, const ViewModel& model) {
  std::sort(correlations.begin(), correlations.end());
  const std::span<const float> sorted(correlations);
  ViewSupport support;
  support.area = AgreeingShare(sorted, model.cell_sigma);
  const auto best_count = static_cast<std::size_t>(model.local_share * static_cast<double>(sorted.size()));
  const std::span<const float> rest = sorted.first(sorted.size() - best_count);
  const std::span<const float> best = best_count > 0 ? sorted.last(best_count) : sorted.last(1);
  const double rest_sigma = model.cell_sigma / std::sqrt(static_cast<double>(rest.size()));
  support.log10_odds = Log10OddsOfRest(MeanOf(rest), std::max(MeanOf(best), model.cell_sigma), rest_sigma);
  return support;
}

}  // namespace floorloc
