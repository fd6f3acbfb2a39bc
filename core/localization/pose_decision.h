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

/// What poses are compared by.
struct PoseEvidence {
  float max_distance = 0.0F;          ///< at which descriptors still count as alike
  std::vector<int> cell_of_keypoint;  ///< cell of the frame in which a keypoint of the frame lies; -1: none
  bool floor_repeats = false;         ///< the floor looks alike in several places
};

/// A pose must be beyond chance by all its keypoints, and by the distinctive matches that went there and nowhere else;
/// on a floor that does not repeat itself a frame that agrees all over with the mosaic is as good.
/// Rivals are compared keypoint by keypoint and cell by cell of the frame: on self-similar floors much fits several
/// places, and only by how much better it fits one of them says which. Where both were aligned to the mosaic, only the
/// part of the frame counts that shows surveyed floor under both poses: beyond the map's edge nothing can be compared.
PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, const PoseEvidence& evidence,
                        const RegistrationOptions& options);

}  // namespace floorloc
