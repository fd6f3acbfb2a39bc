// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/fusion/filter_options.h"
#include "core/fusion/measurements.h"
#include "core/fusion/wheel_hypotheses.h"

namespace floorloc {

/// Estimates how much later the wheels are stamped than the images: the shift at which what the wheels say between
/// fixes fits them best, where turns and accelerations tell shifts apart. Bounded memory.
class ClockOffset {
 public:
  explicit ClockOffset(const OdometryMonitorOptions& options) : options_(options) {}

  /// A fix later than the last one. Returns true when another offset was found, not when one is only known better.
  bool AddFix(const PoseFix& fix, const WheelHypotheses& wheels);
  void Clear();
  /// Starts with an offset that was found before.
  void ResumeAt(std::int64_t offset_ns) { offset_ns_ = offset_ns; }
  std::int64_t offset_ns() const { return offset_ns_; }

 private:
  struct Misfit {
    double per_interval = 0.0;  ///< mean of squared residuals against their sigma, each at most kMaxCost
    double total = 0.0;
    int intervals = 0;
  };
  Misfit MisfitAt(std::int64_t offset_ns, const WheelHypotheses& wheels) const;
  std::int64_t BestNear(std::int64_t middle_ns, std::int64_t reach_ns, std::int64_t step_ns,
                        const WheelHypotheses& wheels) const;

  const OdometryMonitorOptions options_;
  std::deque<PoseFix> fixes_;
  std::int64_t offset_ns_ = 0;
  std::optional<std::int64_t> candidate_ns_;  // found by the last search
  std::int64_t last_search_ns_ = 0;
};

}  // namespace floorloc
