// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/localization/candidate_search.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localization_result.h"
#include "core/localization/localizer_options.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/search_scope.h"
#include "core/registration/pose_choice.h"

namespace floorloc {

/// A decided search; poses are relative to the keypoints' origin.
struct DecidedSearch {
  const SearchScope& scope;
  const std::vector<VerifiedPose>& poses;
  const PoseDecision& decision;
};

/// True when the frame correlates with the mosaic near the pose by keypoints: a fit can diverge.
bool Agrees(const PhotometricFit& photo, const LocalizerOptions& options);

/// Writes status, pose and covariance to the result.
void FillResult(const FrameObservation& frame, const DecidedSearch& search, const LocalizerOptions& options,
                LocalizationResult* result);

/// The pose modulo the lattice, where the best pose agrees with the mosaic. compared: at the places of the lattice, or
/// nothing.
std::optional<LatticeObservation> ObserveLattice(const FrameObservation& frame, const DecidedSearch& search,
                                                 const std::optional<LatticeComparison>& compared,
                                                 const LocalizerOptions& options);

}  // namespace floorloc
