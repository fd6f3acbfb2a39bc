// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/imu_track.h"
#include "core/fusion/motion_track.h"

namespace floorloc {

/// Everything that measures a vehicle's motion.
struct MotionRecord {
  MotionTrack wheels;
  MotionTrack vision;
  ImuTrack imu;
};

/// Propagates a state to a later time: the prediction of the Kalman filter. Wheels, else the IMU, else the last
/// velocity give the motion of each interval; the IMU corrects it where the wheels turn. The motion of an interval is
/// an error of its own until it is added to the pose.
void Propagate(const MotionRecord& record, const PoseFilterOptions& options, std::int64_t to_ns, FilterState* state);

}  // namespace floorloc
