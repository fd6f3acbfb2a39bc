// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// What becomes a candidate pose, and which candidates are rivals. Each number names the commit that chose it; `./run
/// bench honesty` checks them.
struct SearchOptions {
  /// Nearest neighbours in the whole map that vote, per keypoint, when too few matches are distinctive (b39d290).
  int votes_per_keypoint = 2;
  /// Largest Hamming distance of a neighbour that votes (b39d290).
  float max_vote_distance = 64.0F;
  /// Prior weight of a pose outside the prior relative to one inside: how often a prior is wrong (2407dfd).
  double prior_failure_rate = 1e-3;
  /// On a self-similar floor a prior that states a smaller risk (PosePrior::p_elsewhere) is not questioned: poses
  /// outside it do not compete.
  double unquestioned_p_elsewhere = 2e-6;
  /// On a floor that is not self-similar, a candidate with fewer inliers than this share of the first one's supporting
  /// keypoints is no rival (2407dfd) ...
  double min_rival_share = 0.25;
  /// ... when the first one's log10 of the number of false alarms is below this (2407dfd).
  double clear_log10_nfa = -20.0;
  /// Images of a lower JPEG quality lose what floors are recognized by, and are searched for more thoroughly where the
  /// rest finds nothing: at 40 every hard frame of a faint concrete floor is found, at 30 three quarters
  /// (docs/benchmarks/compression.md, as all of these).
  int poor_jpeg_quality = 40;
  /// Neighbours that vote per keypoint of such an image: its descriptors are off by more bits than those of other
  /// floor. Of the concrete's mild frames of quality 20, 2 neighbours find 75 %, 6 find 90 %, 20 all ...
  int thorough_votes = 20;
  float thorough_vote_distance = 90.0F;  ///< ... their largest Hamming distance ...
  int thorough_candidates = 50;          ///< ... and poses that are verified: hard frames 19 % with 10, 24 % with 50
  /// Step between the headings at which keypoints are compared with upright descriptors: 6 degrees off, they are still
  /// better than those at the keypoints' own angles, 10 degrees off no more (`./run bench descriptors`).
  double heading_step_rad = 0.21;
  /// Keypoints of the largest response that a search of the whole map at all headings takes; each votes as often as in
  /// the search by its own angle. Of hard frames of a photographed floor from 0.8 m, on a map from 0.4 m, 52 % are
  /// found without this search, 72 % with 100 keypoints, 73 % with 300 (docs/benchmarks/extractors.md) ...
  int heading_keypoints = 100;
  /// ... and of an image that lost much by compression: hard frames of quality 20 on faint concrete 28 % by the
  /// keypoints' own angles, 34 % with 100 keypoints and 2 votes, 48 % with 300 and 6 (docs/benchmarks/compression.md).
  int thorough_heading_keypoints = 300;
  int thorough_heading_votes = 6;
  float thorough_heading_distance = 80.0F;
  /// The same in the search modulo a lattice (SearchScope::modulo), where a keypoint has a copy at every place.
  int modulo_keypoints = 200;
  int modulo_votes = 10;
  float modulo_distance = 72.0F;
  int modulo_candidates = 3;  ///< poses that are verified and aligned to the mosaic

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

}  // namespace floorloc
