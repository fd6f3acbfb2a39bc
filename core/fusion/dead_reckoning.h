// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/imu_track.h"
#include "core/fusion/motion_track.h"

namespace floorloc {

/// All motion measurements of a vehicle.
struct MotionRecord {
  MotionTrack wheels;
  MotionTrack vision;
  ImuTrack imu;
  bool trust_wheels = true;  ///< false: wheels move odom_from_base only, the pose is moved by the others
  bool trust_imu = true;     ///< false: it moves nothing

  void Clear() {
    wheels.Clear();
    vision.Clear();
    imu.Clear();
  }
};

/// Propagates a state to a later time: the prediction of the Kalman filter. Trusted wheels, else the IMU, else the last
/// velocity give the motion of each interval; where wheels and IMU cover an interval, the IMU corrects the wheels. The
/// error of the interval's motion is part of the error state until the motion is added to the pose.
void Propagate(const MotionRecord& record, const PoseFilterOptions& options, std::int64_t to_ns, FilterState* state);

}  // namespace floorloc
