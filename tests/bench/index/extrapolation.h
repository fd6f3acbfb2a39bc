// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/bench/index/index_trial.h"

namespace floorloc {

/// What a method would take on a larger floor, by the power law through its two largest trials: times grow with area,
/// everything that was counted is left out. `trials` must hold at least one.
IndexTrial Extrapolate(const std::vector<IndexTrial>& trials, double area_m2);

}  // namespace floorloc
