// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/fusion/fault_score.h"

namespace floorloc {

/// Scores of all variants under one fault at one rate of images.
struct FaultRow {
  std::string fault;
  double images_per_s = 0.0;
  std::vector<FaultScore> scores;  ///< one per variant
};

/// The filter with all it knows, as it was before it judged the wheels, without wheels, and the last fix held.
std::vector<FusionVariant> AllFaultVariants();

/// Prints Markdown: a row per fault and rate, a column per variant, and a legend.
void PrintFaultTable(std::ostream& out, const std::vector<FusionVariant>& variants, const std::vector<FaultRow>& rows);

}  // namespace floorloc
