// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/readout_estimator.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

struct Weighted {
  double value = 0.0;
  double weight = 1.0;
};

double WeightedMedian(std::vector<Weighted> values) {
  std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double half = 0.0;
  for (const Weighted& v : values) {
    half += 0.5 * v.weight;
  }
  for (const Weighted& v : values) {
    half -= v.weight;
    if (half <= 0.0) {
      return v.value;
    }
  }
  return values.back().value;
}

}  // namespace

void ReadoutEstimatorOptions::Check() const {
  RequireOption(min_images >= 2, "min_images must be at least 2");
  RequireOption(max_sigma_s > 0.0, "max_sigma_s must be positive");
  RequireOption(global_sigmas >= 0.0, "global_sigmas must not be negative");
  RequireOption(global_s >= 0.0, "global_s must not be negative");
  RequireOption(max_images >= static_cast<std::size_t>(min_images), "max_images must be at least min_images");
}

ReadoutEstimator::ReadoutEstimator(const ReadoutEstimatorOptions& options) : options_(options) { options_.Check(); }

void ReadoutEstimator::Add(const ReadoutMeasurement& measurement) {
  if (measurements_.size() == options_.max_images) {
    measurements_.erase(measurements_.begin());
  }
  measurements_.push_back(measurement);
}

void ReadoutEstimator::Resume(const std::vector<ReadoutMeasurement>& measurements) {
  const std::size_t dropped = measurements.size() - std::min(measurements.size(), options_.max_images);
  measurements_.assign(measurements.begin() + static_cast<std::ptrdiff_t>(dropped), measurements.end());
}

std::optional<ReadoutMeasurement> ReadoutEstimator::Estimate() const {
  if (images() < options_.min_images) {
    return std::nullopt;
  }
  const auto weight = [](const ReadoutMeasurement& m) { return 1.0 / (m.sigma_s * m.sigma_s); };
  std::vector<Weighted> values;
  for (const ReadoutMeasurement& m : measurements_) {
    values.push_back({m.seconds, weight(m)});
  }
  ReadoutMeasurement estimate;
  estimate.seconds = WeightedMedian(values);
  double best_s = measurements_.front().sigma_s;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].value = std::abs(values[i].value - estimate.seconds);
    best_s = std::min(best_s, measurements_[i].sigma_s);
  }
  // Of a median, by the median deviation; what the calibration shears all images by does not average out.
  const double scatter_s = 1.253 * 1.4826 * WeightedMedian(values) / std::sqrt(static_cast<double>(images()));
  estimate.sigma_s = std::hypot(scatter_s, 0.5 * best_s);
  if (std::abs(estimate.seconds) < std::min(options_.global_s, options_.global_sigmas * estimate.sigma_s)) {
    estimate.seconds = 0.0;
  }
  return estimate.sigma_s <= options_.max_sigma_s ? std::optional(estimate) : std::nullopt;
}

}  // namespace floorloc
