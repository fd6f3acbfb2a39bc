// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/lattice/lattice_comparison.h"
#include "core/localization/pose_verifier.h"
#include "core/registration/pose_choice.h"
#include "core/registration/registration.h"

namespace floorloc {

/// Parameters that separate right poses from wrong ones. Each names the commit that chose it; `./run bench honesty`
/// checks them.
struct DecisionOptions {
  /// Exponent of the chance probabilities of distinctive matches and of the mosaic: floors repeat themselves more than
  /// independent points would, so that a modelled probability of p is really p^structure_exponent (c76363b).
  double structure_exponent = 0.5;
  /// Standard deviation of a cell's correlation where frame and mosaic show different floor (2407dfd).
  double cell_sigma = 0.2;
  /// Share of the cells, the worst ones, whose correlation measures the agreement with the mosaic: a few lines that
  /// cross the whole floor do not count (2407dfd).
  double trimmed_share = 0.75;
  /// Correlations of cells are clamped to this: near 1 Fisher's transformation exaggerates small differences (13d8f43).
  double max_correlation = 0.98;
  /// Share of distinctive matches among a pose's inliers on a self-similar floor: 0.2 on simulated tiles, from hard to
  /// clean images (fae08be).
  double distinctive_share = 0.2;
  /// Probability that a similar place is accepted when the right pose is not among the candidates (b82405e).
  double look_alike_taken = 0.05;
  /// Largest share of the view in which something else than the floor may match: a part of the robot, dirt, a sticker,
  /// seen by survey and vehicle alike. `./run bench honesty --overlay` has parts of up to 30 %, which touch 35 % of the
  /// cells. A right pose must agree with more of the view.
  double local_share = 0.35;
  /// A mosaic whose pixels are larger than this many of the frame's is not compared: fine structure is lost, and cells
  /// agree by chance. At 8 poses of a map of the tests are up to 4 mm off by its mosaic, below 2 mm by keypoints.
  double max_mosaic_coarseness = 3.0;
  /// Above this p_wrong the keypoints alone do not decide: all poses are aligned to the mosaic (13d8f43).
  double clear_p_wrong = 1e-6;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Evidence of a frame by which its poses are compared.
struct PoseEvidence {
  float max_distance = 0.0F;          ///< at which descriptors still count as similar
  std::vector<int> cell_of_keypoint;  ///< cell of the frame in which a keypoint of the frame lies; -1: none
  bool floor_repeats = false;         ///< the floor is self-similar
  /// The frame at every place of the floor's lattice, where that was compared; poses as those to decide among.
  const LatticeComparison* lattice = nullptr;
};

/// Chooses the pose of a frame. It must be significant by all its keypoints and by the distinctive matches that support
/// it; on a floor that is not self-similar, agreement of the whole frame with the mosaic may replace the latter. Poses
/// are compared in pairs, keypoint by keypoint and cell by cell of the frame: on self-similar floors most keypoints fit
/// several places, and only the difference of fit discriminates. Where both poses were aligned to the mosaic, only
/// cells that show surveyed floor under both count: beyond the map's edge nothing can be compared. A pose is a
/// statement about the whole view: one whose view agrees with the mosaic in one part only is not chosen, whatever that
/// part holds.
PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, const PoseEvidence& evidence,
                        const RegistrationOptions& registration, const DecisionOptions& options);

}  // namespace floorloc
