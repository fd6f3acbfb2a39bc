// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "server/bridge/protocol.h"
#include "server/bridge/server_reports.h"

namespace floorloc {

struct VelocityOptions {
  double span_s = 0.25;    ///< difference of poses so far apart: at 1 mm, velocities are good to 6 mm/s
  double max_gap_s = 1.0;  ///< poses further apart than this tell no velocity
};

/// The velocity of a vehicle in its base frame, from poses that the server reports.
class VelocityEstimator {
 public:
  explicit VelocityEstimator(VelocityOptions options = {}) : options_(options) {}

  /// Poses of another epoch, or with older stamps, start over.
  void Add(const PoseReport& report);
  void Reset() { poses_.clear(); }
  /// Empty while it is not known.
  std::optional<Velocity> velocity() const;

 private:
  VelocityOptions options_;
  std::int64_t epoch_ = 0;
  std::deque<ReportedPose> poses_;
};

}  // namespace floorloc
