// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/imu_track.h"
#include "core/fusion/motion_track.h"

namespace floorloc {

/// Everything that tells of a vehicle's motion.
struct MotionRecord {
  MotionTrack wheels;
  MotionTrack vision;
  ImuTrack imu;
};

/// Carries a state on to a later time: the prediction of the Kalman filter. Wheels, else the IMU, else the last
/// velocity tell the motion of each stretch; the IMU is weighed in where the wheels turn. The motion of a stretch is an
/// error of its own until it is added to the pose.
void CarryOn(const MotionRecord& record, const PoseFilterOptions& options, std::int64_t to_ns, FilterState* state);

}  // namespace floorloc
