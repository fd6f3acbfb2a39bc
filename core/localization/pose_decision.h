// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/localization/pose_verifier.h"
#include "core/registration/pose_choice.h"
#include "core/registration/registration.h"

namespace floorloc {

/// What tells the right pose from a wrong one. Each number names the commit that chose it; whether it still holds is
/// for
/// `./run bench honesty` to say.
struct DecisionOptions {
  /// Floors repeat themselves more than independent points would: of the distinctive matches and of the mosaic, what
  /// looks like a chance of p happens with p^this (c76363b).
  double structure_exponent = 0.5;
  /// Spread of a cell's correlation where frame and mosaic show different floor (2407dfd).
  double cell_sigma = 0.2;
  /// Share of the cells, the worst ones, by which a frame agrees with the mosaic: a few lines that cross the whole
  /// floor do not count (2407dfd).
  double trimmed_share = 0.75;
  /// Correlations of cells are compared up to this; beyond, Fisher's transformation makes too much of little (13d8f43).
  double max_correlation = 0.98;
  /// Share of a pose's inliers that are distinctive matches on a floor that repeats itself: 0.2 on simulated tiles,
  /// hard to clean (fae08be).
  double distinctive_share = 0.2;
  /// How often a look-alike is taken for the right pose when that one is not among the candidates (b82405e).
  double look_alike_taken = 0.05;
  /// Above this p_wrong the keypoints alone do not decide: all poses are aligned to the mosaic (13d8f43).
  double clear_p_wrong = 1e-6;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Evidence by which poses are compared.
struct PoseEvidence {
  float max_distance = 0.0F;          ///< at which descriptors still count as similar
  std::vector<int> cell_of_keypoint;  ///< cell of the frame in which a keypoint of the frame lies; -1: none
  bool floor_repeats = false;         ///< the floor is self-similar
};

/// A pose must be beyond chance by all its keypoints, and by the distinctive matches that support this pose alone; on a
/// floor that does not repeat itself a frame that agrees all over with the mosaic is as good.
/// Every two poses are compared keypoint by keypoint and cell by cell of the frame: on self-similar floors much fits
/// several places, and only the difference of fit discriminates between them. Where both were aligned to the mosaic,
/// only the part of the frame counts that shows surveyed floor under both poses: beyond the map's edge nothing can be
/// compared.
PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, const PoseEvidence& evidence,
                        const RegistrationOptions& registration, const DecisionOptions& options);

}  // namespace floorloc
