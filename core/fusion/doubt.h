// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/fusion/filter_options.h"
#include "core/fusion/fused_pose.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// What fixes that were not accepted say of a pose: how far it may be off, and whether they are many enough to be
/// believed rather than the motion sensors.
class Doubt {
 public:
  explicit Doubt(const OdometryMonitorOptions& options) : options_(options) {}

  /// A fix that was compared with the pose predicted for its time.
  void Note(const PoseFix& fix, const FixOutcome& outcome);
  /// The pose was set anew, by a fix or by hand.
  void Settle(const std::optional<PoseFix>& fix);

  /// Rejected fixes since the last accepted one.
  int rejected_in_a_row() const { return static_cast<int>(rejected_.size()); }
  /// True when fixes near the pose were refused again and again of late: the noise of the sensors is larger than
  /// thought.
  bool IsSuspect() const { return suspicion_ >= kSuspicious; }
  /// True when most of the last fixes were refused, though poses were set anew in between: a sensor lies.
  bool IsRestless() const { return restlessness_ >= kRestless; }
  /// True when a vehicle can get from the last accepted fix to the newest, rejected one.
  bool IsReachable() const;
  /// The last fix before the newest, accepted or not, when a vehicle can get from it to the newest one.
  std::optional<PoseFix> Previous() const;

  /// What to add to the covariance of a pose at a time: what the last contradiction showed, which grows with time.
  Eigen::Matrix3d CovarianceAt(std::int64_t stamp_ns) const;

 private:
  static constexpr double kSuspicious = 1.5;  // two fixes of the last few

  static constexpr double kRestless = 2.5;  // three in a row are a kidnapping, four of six are not

  const OdometryMonitorOptions options_;
  std::optional<PoseFix> accepted_;
  std::deque<PoseFix> rejected_;  // since then
  double distance_m_ = 0.0;       // of the last rejected one
  double angle_rad_ = 0.0;
  double suspicion_ = 0.0;     // by refused fixes near the pose; decays with every fix
  double restlessness_ = 0.0;  // by all refused fixes, likewise
};

}  // namespace floorloc
