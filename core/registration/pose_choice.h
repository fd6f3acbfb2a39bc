// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/registration/registration.h"

namespace floorloc {

/// Mutually exclusive poses of one frame, before the choice.
struct PoseContest {
  /// weight: odds of the pose against the best one; 1 for the best one itself, 0 for a pose that is no rival.
  std::vector<PoseHypothesis> hypotheses;
  std::size_t best = 0;   ///< index of the most probable one
  double p_chance = 1.0;  ///< probability of a pose as good as the best one by chance alone
  double p_local = 0.0;   ///< probability that the best one holds for a part of the view only, which is not floor
  double p_missed = 0.0;  ///< probability that the right pose is not among the hypotheses
};

/// Decision about the poses of a frame.
struct PoseDecision {
  RegistrationStatus status = RegistrationStatus::kTooFewInliers;
  int best = -1;         ///< index of the best pose; -1 when none is worth reporting
  double p_wrong = 1.0;  ///< by chance, or because a rival is the right one
  /// Rivals with a weight above max_p_wrong; when ambiguous, the best pose comes first.
  std::vector<PoseHypothesis> alternatives;
};

/// Decides for registration and localization alike, which differ in how they compute the odds. Weights are the odds
/// divided by their sum (Bayes' rule for exclusive hypotheses), so that k equal poses have 1/k each.
PoseDecision ChoosePose(const PoseContest& contest, const RegistrationOptions& options);

}  // namespace floorloc
