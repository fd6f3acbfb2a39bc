// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/fusion/fusion_score.h"

namespace floorloc {

/// How every variant did under one scenario.
struct FusionRow {
  std::string scenario;
  std::vector<FusionScore> scores;  ///< as many as there are variants
};

/// Prints Markdown tables, one for each question, a row per scenario and a column per variant, and what the numbers
/// mean.
void PrintFusionTables(std::ostream& out, const std::vector<FusionVariant>& variants,
                       const std::vector<FusionRow>& rows);

}  // namespace floorloc
