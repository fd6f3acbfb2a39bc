// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/fused_pose.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Compares a fix with the state predicted for its time: gates of p_wrong, distance, angle and Mahalanobis distance, in
/// this order. The reason is the first gate that fails.
FixOutcome GateFix(const PoseFix& fix, const FilterState& predicted, const FixGates& gates);

/// Adapts the noise of the wheels to the innovation of a fix.
void AdaptWheelNoise(const PoseFix& fix, const NoiseAdaptation& adaptation, FilterState* predicted);

/// Kalman correction of the state by a fix of its time.
void CorrectByFix(const PoseFix& fix, FilterState* state);

/// Resets the pose to that of a fix, without correlation to the state before. The rest of the state is kept.
void ResetToFix(const PoseFix& fix, const SharedFixNoise& shared, FilterState* state);

/// The same for a pose that is not a fix. covariance: in the base frame.
void ResetPose(const Pose2& map_from_base, const Eigen::Matrix3d& covariance, FilterState* state);

/// True when the numbers of a fix are finite and its covariance is positive definite.
bool IsValid(const PoseFix& fix);

}  // namespace floorloc
