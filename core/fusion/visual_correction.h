// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Kalman's correction of the state, which is that of the picture's time, by the motion that visual odometry has up to
/// it. A motion that does not begin at the last picture begins a new visual pose. Where the pictures contradict the
/// prediction, they are believed: wheels slip.
void CorrectByVision(const MotionIncrement& motion, const PoseFilterOptions& options, FilterState* state);

}  // namespace floorloc
