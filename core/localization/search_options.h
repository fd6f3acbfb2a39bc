// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// What becomes a candidate pose, and which candidates are rivals. Each number names the commit that chose it; whether
/// it still holds is for `./run bench honesty` to say.
struct SearchOptions {
  /// Neighbours of each keypoint that vote, of the whole map, when too few matches are distinctive (b39d290).
  int votes_per_keypoint = 2;
  /// Bits by which a neighbour that votes differs at most (b39d290).
  float max_vote_distance = 64.0F;
  /// How often a prior does not hold: the weight of a place outside it, relative to one inside (2407dfd).
  double prior_failure_rate = 1e-3;
  /// On a floor that does not repeat itself, a candidate with a smaller share of the supporting keypoints of the best
  /// one is no rival (2407dfd) ...
  double min_rival_share = 0.25;
  /// ... when the best one's log10 of the number of false alarms is below this (2407dfd).
  double clear_log10_nfa = -20.0;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

}  // namespace floorloc
