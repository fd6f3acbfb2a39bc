// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/localization/pose_prior.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// Region and effort of a search.
struct SearchScope {
  std::optional<PosePrior> prior;
  std::optional<MatchGuide> guide;  ///< follows from the prior
  int probes = 0;                   ///< buckets of the index, without a prior; 0: as in IndexOptions
  bool indistinct = false;          ///< without a prior: all near neighbours vote, not only distinctive ones
  bool thorough = false;  ///< more neighbours vote and more poses are verified; with a prior: all nearest ones vote

  bool Contains(const Pose2& map_from_base) const;
};

/// Searches to try in turn until a pose is accepted: the first one usually suffices. Without a prior a self-similar
/// floor is searched once, with all probes of the index, to find the rivals. roi: base frame.
std::vector<SearchScope> SearchScopes(const std::optional<PosePrior>& prior, const RectM& roi, bool floor_repeats);

/// The search to add for an image that lost much by compression.
SearchScope ThoroughScope(const std::optional<PosePrior>& prior, const RectM& roi);

}  // namespace floorloc
