// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// The state before anything was measured.
FilterState InitialState(std::int64_t stamp_ns, const PoseFilterOptions& options);

/// The velocity as in `initial`, what was learnt of IMU and wheels as in `imu` and `wheels`; none depends on the pose.
void ForgetSensors(const FilterState& initial, const FilterState& imu, const FilterState& wheels, FilterState* state);

/// The mean velocity between two fixes, weighted against a vehicle that may do anything.
void SetVelocity(const PoseFix& from, const PoseFix& to, const MotionPrior& prior, FilterState* state);

/// The factor on the wheels' noise at which being off by off_m after path_m is four standard deviations; not less than
/// that of the state, nor more than NoiseAdaptation::max_factor.
double RaisedNoiseFactor(const FilterState& state, double off_m, double path_m, const PoseFilterOptions& options);

}  // namespace floorloc
