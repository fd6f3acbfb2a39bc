// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/registration/registration.h"
#include "core/vision/matching/descriptor_index.h"
#include "tests/bench/index/big_floor.h"

namespace floorloc {

/// How a frame is searched on the whole floor.
struct GlobalSearchOptions {
  std::vector<int> efforts = {16, 128, 1024};  ///< probes per keypoint, until a pose is beyond chance
  int neighbours = 2;                          ///< per keypoint; each of them votes
  float max_distance = 64.0F;                  ///< bits
  double max_log10_nfa = -6.0;                 ///< log10 of the poses that chance would give
  RegistrationOptions registration;
};

struct GlobalSearchResult {
  std::optional<Pose2> floor_from_base;
  int effort = 0;              ///< probes of the last search
  double ms = 0.0;             ///< processor time
  std::vector<Match> matches;  ///< of the last search
};

/// From descriptors to a pose that is beyond chance, or none.
GlobalSearchResult SearchGlobally(const DescriptorIndex& index, const BigFloor& floor, const Features& frame,
                                  const GlobalSearchOptions& options);

}  // namespace floorloc
