// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/fused_pose.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Compares a fix with the state of its time: risk, distance, angle and Mahalanobis gates, in this order. The first
/// that does not pass is the reason.
FixOutcome JudgeFix(const PoseFix& fix, const FilterState& predicted, const FixGates& gates);

/// Adapts the noise of the wheels by how well a fix meets what they predicted.
void AdaptWheelNoise(const PoseFix& fix, const NoiseAdaptation& adaptation, FilterState* predicted);

/// Kalman's correction of the state by a fix of its time.
void CorrectByFix(const PoseFix& fix, FilterState* state);

/// Puts the state where a fix is, without correlation to what was before. All else stays.
void PlaceAtFix(const PoseFix& fix, const SharedFixNoise& shared, FilterState* state);

/// The same for a pose that is no fix. covariance: in the base frame.
void PlaceAt(const Pose2& map_from_base, const Eigen::Matrix3d& covariance, FilterState* state);

/// True when the numbers of a fix can be worked with.
bool IsValid(const PoseFix& fix);

}  // namespace floorloc
