// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/fusion/fusion_score.h"

namespace floorloc {

/// Scores of all variants under one scenario.
struct FusionRow {
  std::string scenario;
  std::vector<FusionScore> scores;  ///< one per variant
};

/// Prints one Markdown table per measure, with a row per scenario and a column per variant, and a legend.
void PrintFusionTables(std::ostream& out, const std::vector<FusionVariant>& variants,
                       const std::vector<FusionRow>& rows);

}  // namespace floorloc
