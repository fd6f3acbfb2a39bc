// SPDX-License-Identifier: Apache-2.0
#include "core/localization/oriented_matches.h"

namespace floorloc {

std::vector<OrientedMatch> ToOrientedMatches(const std::vector<Match>& matches, const std::vector<Keypoint>& query,
                                             const std::vector<Keypoint>& train) {
  std::vector<OrientedMatch> oriented;
  oriented.reserve(matches.size());
  for (const Match& match : matches) {
    const Keypoint& from = query[static_cast<std::size_t>(match.query)];
    const Keypoint& to = train[static_cast<std::size_t>(match.train)];
    oriented.push_back({from.Position(), to.Position(), from.angle_rad, to.angle_rad});
  }
  return oriented;
}

}  // namespace floorloc
