// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/registration/registration.h"
#include "core/vision/matching/descriptor_index.h"
#include "tests/bench/index/big_floor.h"

namespace floorloc {

/// Options of the search for a frame on the whole floor.
struct GlobalSearchOptions {
  std::vector<int> efforts = {16, 128, 1024};  ///< probes per keypoint, increased until a pose is significant
  int neighbours = 2;                          ///< per keypoint; each of them votes
  float max_distance = 64.0F;                  ///< bits
  double max_log10_nfa = -6.0;                 ///< significance: log10 of the expected number of false poses
  RegistrationOptions registration;
};

struct GlobalSearchResult {
  std::optional<Pose2> floor_from_base;
  int effort = 0;              ///< probes of the last search
  double ms = 0.0;             ///< CPU time
  std::vector<Match> matches;  ///< of the last search
};

/// Matches the descriptors and searches a significant pose; none when there is none.
GlobalSearchResult SearchGlobally(const DescriptorIndex& index, const BigFloor& floor, const Features& frame,
                                  const GlobalSearchOptions& options);

}  // namespace floorloc
