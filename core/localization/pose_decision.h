// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/localization/pose_verifier.h"
#include "core/registration/registration.h"

namespace floorloc {

/// What to make of the verified poses of a frame.
struct PoseDecision {
  RegistrationStatus status = RegistrationStatus::kTooFewInliers;
  int best = -1;                             ///< index of the best pose; -1 when none is worth reporting
  double p_wrong = 1.0;                      ///< by chance, or because a rival is the right one
  std::vector<PoseHypothesis> alternatives;  ///< when ambiguous, the best one first
};

/// A pose must be beyond chance by all its keypoints, and by the distinctive matches that went there and nowhere else.
/// Rivals are compared keypoint by keypoint and cell by cell of the picture: on self-similar floors much fits several
/// places, and only by how much better it fits one of them says which.
/// max_distance: at which descriptors still count as alike.
PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, float max_distance, const RegistrationOptions& options);

}  // namespace floorloc
