// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Kalman's correction of the state, which is that of the picture's time, by the motion that visual odometry has up to
/// it. A motion that does not begin at the last picture begins a new visual pose.
void CorrectByVision(const MotionIncrement& motion, const VisionNoise& noise, FilterState* state);

}  // namespace floorloc
