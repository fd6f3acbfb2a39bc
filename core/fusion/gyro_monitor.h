// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "core/fusion/filter_options.h"
#include "core/fusion/imu_track.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Judges a gyro by the fixes: the turn from one to the next needs no sensor. A sign, a unit or an axis that is wrong
/// shows in every turn; a small bias or error of scale does not matter here, the filter learns it. A wrong fix does not
/// accuse the gyro: the fixes before and after it agree with it.
class GyroMonitor {
 public:
  explicit GyroMonitor(const GyroMonitorOptions& options) : options_(options) {}

  /// A fix whose own risk is low; fixes older than the last one are ignored. imu: its readings up to the fix.
  void AddFix(const PoseFix& fix, const ImuTrack& imu);
  /// After a jump of the clock.
  void Clear() { fixes_.clear(); }

  /// True: the IMU may move the pose.
  bool Trusted() const { return !rejected_; }

 private:
  enum class Verdict { kContradicts, kAgrees, kSaysNothing };

  Verdict Compare(const PoseFix& from, const PoseFix& to, const ImuTrack& imu) const;
  Verdict Judge(const ImuTrack& imu) const;

  const GyroMonitorOptions options_;
  std::deque<PoseFix> fixes_;  // the last three
  int against_ = 0;            // verdicts against what is believed of the gyro, without one for it between them
  bool rejected_ = false;
};

}  // namespace floorloc
