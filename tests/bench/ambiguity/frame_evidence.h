// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/lattice/lattice_observation.h"
#include "core/localization/localization_result.h"

namespace floorloc {

/// A pose that a frame leaves possible.
struct PossiblePose {
  Pose2 map_from_base;
  double log_likelihood = 0.0;  ///< natural logarithm, relative to the frame's other poses
};

/// What a frame tells of where it was taken. Without poses it tells nothing.
struct FrameEvidence {
  std::vector<PossiblePose> poses;
  double log_elsewhere = 0.0;  ///< log-likelihood of any other pose
};

/// Of the localizer's answer without a prior: its pose where it is localized, else all places of the floor's lattice on
/// the map or, off one, its alternatives by their weights.
FrameEvidence EvidenceOf(const LocalizationResult& result);

/// Log-likelihood ratio of being at a place whose score is normal, with mean 0 where it is the wrong one and c times
/// the expected score where it is the right one; c is half-normal with standard deviation 0.5, as worn floor and noise
/// that is not independent make it (LatticeTrackerOptions::gain_sigma).
double LogLikelihoodOfPlace(const LatticePlace& place);

/// log2 of the likelihood of the true place against the mean of the other ones: what the frame tells of which tile it
/// shows. Empty where no places were compared, or not the true one (within 2 cm).
std::optional<double> BitsOfFrame(const LatticeObservation& observation, const Pose2& true_map_from_base);

}  // namespace floorloc
