// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/common/score.h"
#include "tests/bench/fix/methods.h"

namespace floorloc {

/// One method in the table.
struct Column {
  std::string title;     ///< at most 14 letters
  std::string subtitle;  ///< second line of the head
  Score score;
  std::optional<StageTimes> stages;   ///< empty: timed as a whole
  std::optional<double> fixes_per_s;  ///< on all cores
};

/// Prints the methods side by side; ratios are relative to the first column.
void PrintTable(std::ostream& out, const std::vector<Column>& columns);

}  // namespace floorloc
