// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/bench/index/index_trial.h"

namespace floorloc {

/// Extrapolates a method's times to a larger floor by the power law through its two largest trials; counts are not
/// extrapolated. trials: at least one.
IndexTrial Extrapolate(const std::vector<IndexTrial>& trials, double area_m2);

}  // namespace floorloc
