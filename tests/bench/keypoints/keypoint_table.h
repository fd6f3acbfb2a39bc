// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/keypoints/keypoint_trial.h"

namespace floorloc {

/// A row per tally under a line with the name of the group, in the given order of groups.
void PrintTable(std::ostream& out, const std::vector<KeypointTally>& tallies, const std::vector<std::string>& groups);

}  // namespace floorloc
