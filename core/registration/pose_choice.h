// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/registration/registration.h"

namespace floorloc {

/// Poses of one frame of which one at most is right, before the choice.
struct PoseContest {
  /// weight: odds that the pose is right rather than the best one; 1 of the best one itself, 0 of what is no rival.
  std::vector<PoseHypothesis> hypotheses;
  std::size_t best = 0;   ///< index of the most probable one
  double p_chance = 1.0;  ///< that chance alone offers a pose as good as the best one
  double p_missed = 0.0;  ///< that the right pose is not among the hypotheses
};

/// What to make of the poses of a frame.
struct PoseDecision {
  RegistrationStatus status = RegistrationStatus::kTooFewInliers;
  int best = -1;         ///< index of the best pose; -1 when none is worth reporting
  double p_wrong = 1.0;  ///< by chance, or because a rival is the right one
  /// Of a weight above max_p_wrong; when ambiguous the best one stands among them, first.
  std::vector<PoseHypothesis> alternatives;
};

/// The one decision of the system, whatever the odds come from. Weights are the odds divided by their sum (Bayes' rule
/// for exclusive hypotheses), so that k equal poses have 1/k each.
PoseDecision ChoosePose(const PoseContest& contest, const RegistrationOptions& options);

}  // namespace floorloc
