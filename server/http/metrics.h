// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/http/histogram.h"

namespace floorloc {

struct RequestLabels {
  std::string route;  ///< the pattern, not the path: bounds the number of time series
  std::string method;
  int status = 0;
  auto operator<=>(const RequestLabels&) const = default;
};

/// Why a request was not answered as it wanted: the code of a Problem.
struct RefusalLabels {
  std::string route;
  std::string reason;
  auto operator<=>(const RefusalLabels&) const = default;
};

struct LocalizationLabels {
  std::string map;
  std::string status;
  auto operator<=>(const LocalizationLabels&) const = default;
};

/// Part of the work on an image.
struct StageTime {
  std::string stage;
  double seconds = 0.0;  ///< 0: it was not done
};

struct FixFigures {
  int inliers = 0;
  double p_wrong = 1.0;
};

/// What is counted of one localization.
struct LocalizationFigures {
  LocalizationLabels labels;
  std::string work;            ///< class of the queue that it waited in
  double seconds = 0.0;        ///< of computing
  double queue_seconds = 0.0;  ///< waited for a thread
  std::vector<StageTime> stages;
  std::optional<FixFigures> fix;  ///< of one that was localized
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
  std::string label = "";  ///< LabelText of one or several, with commas; gauges of one name must be consecutive
  const char* type = "gauge";
};

/// name="value", escaped.
std::string LabelText(const char* name, const std::string& value);

/// Counters of the server in Prometheus text format. Thread-safe.
class Metrics {
 public:
  /// One that was answered: seconds from the complete request to its response.
  void CountRequest(const RequestLabels& labels, double seconds);
  /// One that was refused, or failed: its time says nothing.
  void CountRefusal(const RequestLabels& labels, const std::string& reason);
  void CountLocalization(const LocalizationFigures& figures);
  void CountMessage(const OutcomeLabels& labels);
  void CountFix(const OutcomeLabels& labels);
  std::string Render(const std::vector<Gauge>& gauges) const;

 private:
  mutable std::mutex mutex_;
  std::map<RequestLabels, std::uint64_t> requests_;
  std::map<RefusalLabels, std::uint64_t> refusals_;
  std::map<std::string, Histogram> request_seconds_;  // by route
  std::map<LocalizationLabels, Histogram> localize_seconds_;
  std::map<std::string, Histogram> stage_seconds_;
  std::map<std::string, Histogram> queue_seconds_;  // by class of work
  std::map<std::string, Histogram> inliers_;        // by map
  std::map<std::string, Histogram> p_wrong_;        // by map
  std::map<OutcomeLabels, std::uint64_t> messages_;
  std::map<OutcomeLabels, std::uint64_t> fixes_;
};

}  // namespace floorloc
