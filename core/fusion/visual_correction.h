// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Kalman correction of the state at the image's time by the motion of visual odometry that ends there. A motion that
/// does not begin at the last image starts a new visual pose. Where the images contradict the prediction (wheel slip),
/// the covariance of the predicted pose is inflated first.
void CorrectByVision(const MotionIncrement& motion, const PoseFilterOptions& options, FilterState* state);

}  // namespace floorloc
