// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/registration/registration.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Converts descriptor matches to pairs of oriented points for registration; query is the source, train the target.
std::vector<OrientedMatch> ToOrientedMatches(const std::vector<Match>& matches, const std::vector<Keypoint>& query,
                                             const std::vector<Keypoint>& train);

}  // namespace floorloc
