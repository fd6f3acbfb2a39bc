// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Kalman correction of the state, which is that of the image's time, by the motion of visual odometry up to it. A
/// motion that does not begin at the last image begins a new visual pose. Where the images contradict the prediction,
/// the images are used: wheels slip.
void CorrectByVision(const MotionIncrement& motion, const PoseFilterOptions& options, FilterState* state);

}  // namespace floorloc
