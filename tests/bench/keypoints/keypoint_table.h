// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/keypoints/keypoint_trial.h"

namespace floorloc {

/// Prints one block per group, in the given order, with one row per tally.
void PrintTable(std::ostream& out, const std::vector<KeypointTally>& tallies, const std::vector<std::string>& groups);

}  // namespace floorloc
