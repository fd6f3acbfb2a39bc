// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace floorloc {

/// Counts of a Prometheus histogram.
class Histogram {
 public:
  /// bounds: upper ends of the buckets, ascending; must outlive the histogram.
  explicit Histogram(std::span<const double> bounds) : bounds_(bounds), counts_(bounds.size(), 0) {}

  void Observe(double value);
  std::span<const double> bounds() const { return bounds_; }
  const std::vector<std::uint64_t>& counts() const { return counts_; }  ///< not cumulative
  std::uint64_t total() const { return total_; }
  double sum() const { return sum_; }

 private:
  std::span<const double> bounds_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t total_ = 0;
  double sum_ = 0.0;
};

/// Bounds for times, seconds: close to each other around 50 and 80 ms, where answers begin to come too late
/// (ServerConfig::deadline_ms).
std::span<const double> SecondsBounds();
/// Bounds for the inliers of a fix.
std::span<const double> InlierBounds();
/// Bounds for probabilities of being wrong.
std::span<const double> RiskBounds();

}  // namespace floorloc
