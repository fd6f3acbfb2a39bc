// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace floorloc {

/// Counts of a Prometheus histogram; bounds in seconds.
class Histogram {
 public:
  static constexpr std::array<double, 14> kBounds = {0.0005, 0.001, 0.002, 0.004, 0.008, 0.015, 0.03,
                                                     0.06,   0.125, 0.25,  0.5,   1.0,   2.5,   10.0};
  void Observe(double seconds);
  const std::array<std::uint64_t, kBounds.size()>& counts() const { return counts_; }  ///< not cumulative
  std::uint64_t total() const { return total_; }
  double sum() const { return sum_; }

 private:
  std::array<std::uint64_t, kBounds.size()> counts_{};
  std::uint64_t total_ = 0;
  double sum_ = 0.0;
};

struct RequestLabels {
  std::string route;  ///< the pattern, not the path: bounds the number of time series
  std::string method;
  int status = 0;
  auto operator<=>(const RequestLabels&) const = default;
};

struct LocalizationLabels {
  std::string map;
  std::string status;
  auto operator<=>(const LocalizationLabels&) const = default;
};

/// Outcome of a vehicle's message or of its image's fix, per map.
struct OutcomeLabels {
  std::string map;
  std::string outcome;
  auto operator<=>(const OutcomeLabels&) const = default;
};

/// A value read when the metrics are requested.
struct Gauge {
  std::string name;
  std::string help;
  double value = 0.0;
  std::string label = "";  ///< name="value"; gauges of one name must be consecutive
};

/// Counters of the server in Prometheus text format. Thread-safe.
class Metrics {
 public:
  void CountRequest(const RequestLabels& labels, double seconds);
  void CountLocalization(const LocalizationLabels& labels, double seconds);
  void CountMessage(const OutcomeLabels& labels);
  void CountFix(const OutcomeLabels& labels);
  std::string Render(const std::vector<Gauge>& gauges) const;

 private:
  mutable std::mutex mutex_;
  std::map<RequestLabels, std::uint64_t> requests_;
  std::map<std::string, Histogram> request_seconds_;  // by route
  std::map<LocalizationLabels, std::uint64_t> localizations_;
  std::map<std::string, Histogram> localize_seconds_;  // by map
  std::map<OutcomeLabels, std::uint64_t> messages_;
  std::map<OutcomeLabels, std::uint64_t> fixes_;
};

}  // namespace floorloc
