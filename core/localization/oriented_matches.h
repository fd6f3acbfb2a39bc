// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/registration/registration.h"
#include "core/vision/descriptor_index.h"
#include "core/vision/features/features.h"

namespace floorloc {

/// Matches of descriptors -> pairs of oriented points, for registration.
std::vector<OrientedMatch> ToOrientedMatches(const std::vector<Match>& matches, const std::vector<Keypoint>& query,
                                             const std::vector<Keypoint>& train);

}  // namespace floorloc
