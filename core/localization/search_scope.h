// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/lattice/floor_lattice.h"
#include "core/localization/pose_prior.h"
#include "core/localization/search_options.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// Region and effort of a search.
struct SearchScope {
  std::optional<PosePrior> prior;
  std::optional<MatchGuide> guide;  ///< follows from the prior
  int probes = 0;                   ///< buckets of the index, without a prior; 0: as in IndexOptions
  bool indistinct = false;          ///< without a prior: all near neighbours vote, not only distinctive ones
  /// Headings of the robot in the map at which keypoints are described anew and compared with the map's upright
  /// descriptors, radians; empty: by the keypoints' own angles.
  std::vector<double> headings = {};
  int strongest = 0;  ///< with headings: only that many keypoints, those of the largest response; 0: all
  /// Without a prior: poses that differ by multiples of this lattice are one, for which the matches at all of its
  /// places vote together. Which place it is, keypoints do not tell then.
  std::optional<FloorLattice> modulo = {};
  bool thorough = false;  ///< more neighbours vote and more poses are verified; with a prior: all nearest ones vote

  bool Contains(const Pose2& map_from_base) const;
  /// True when the prior states a risk so small that poses outside it do not compete.
  bool IsUnquestioned(const SearchOptions& options) const;
  /// Prior probability of a pose outside the prior, relative to one inside. 1 where the prior states its risk: whoever
  /// knows that weighs the places himself.
  double WeightOutside(const SearchOptions& options) const;
};

/// What a map allows.
struct SearchableMap {
  bool floor_repeats = false;  ///< it is self-similar
  bool upright = false;        ///< it has upright descriptors
};

/// Searches to try in turn until a pose is accepted: the first one usually suffices. Without a prior a self-similar
/// floor is searched once, with all probes of the index, to find the rivals. roi: base frame.
std::vector<SearchScope> SearchScopes(const std::optional<PosePrior>& prior, const RectM& roi, const SearchableMap& map,
                                      const SearchOptions& options);

/// The search to add on a floor that repeats itself, for a frame without a prior in which too few keypoints match at
/// any one place.
SearchScope ModuloScope(const FloorLattice& lattice, const SearchableMap& map, const SearchOptions& options);

/// The search to add for an image that lost much by compression.
SearchScope ThoroughScope(const std::optional<PosePrior>& prior, const RectM& roi, const SearchableMap& map,
                          const SearchOptions& options);

}  // namespace floorloc
