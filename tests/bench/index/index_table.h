// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "tests/bench/index/index_trial.h"

namespace floorloc {

void PrintHead(std::ostream& out);
/// baseline_ms: search time of brute force on the same floor, for the ratio.
void PrintTrial(std::ostream& out, const IndexTrial& trial, double baseline_ms);

}  // namespace floorloc
