// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/evaluation/consistency.h"
#include "core/fusion/pose_filter.h"
#include "tests/core/fusion/drive_simulation.h"

namespace floorloc::fusion_test {

struct Sensors {
  bool wheels = true;
  bool imu = false;
  bool vision = false;
};

// A drive with all messages in order; the filter runs alongside the truth.
class Drive {
 public:
  Drive(std::uint32_t seed, const Sensors& sensors, const SensorErrors& errors = {},
        const PoseFilterOptions& options = {})
      : simulation(seed, errors), filter(options), sensors_(sensors) {
    filter.AddFix(simulation.Fix(kStartNs, truth));
  }

  // Runs to a time, with a fix every kFixNs unless with_fixes is false.
  void RunTo(double seconds, bool with_fixes = true) {
    for (const std::int64_t end = kStartNs + ToNs(seconds); now_ns < end;) {
      const std::int64_t next = now_ns + kImuNs;
      truth = truth * simulation.Motion(DriveSimulation::Seconds(now_ns), DriveSimulation::Seconds(next));
      now_ns = next;
      if (sensors_.imu) {
        filter.AddImu(simulation.Imu(now_ns));
      }
      if (sensors_.wheels && (now_ns - kStartNs) % kWheelNs == 0) {
        filter.AddIncrement(MotionSource::kWheels, simulation.Wheels(now_ns - kWheelNs, now_ns));
      }
      if ((now_ns - kStartNs) % kFixNs == 0) {
        if (sensors_.vision) {
          filter.AddIncrement(MotionSource::kVision, simulation.Vision(now_ns - kFixNs, now_ns));
        }
        if (with_fixes) {
          last_fix = filter.AddFix(simulation.Fix(now_ns, truth));
        }
      }
    }
  }

  double Nees() const {
    const FusedPose pose = *filter.Estimate();
    return floorloc::Nees(truth, pose.map_from_base, pose.covariance);
  }
  double ErrorM() const { return filter.Estimate()->map_from_base.Between(truth).translation().norm(); }

  DriveSimulation simulation;
  PoseFilter filter;
  Pose2 truth{1.0, 2.0, 0.7};
  std::int64_t now_ns = kStartNs;
  FixOutcome last_fix;

 private:
  Sensors sensors_;
};

}  // namespace floorloc::fusion_test
