// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/bench/ambiguity/start_score.h"

namespace floorloc {

/// Scores of one floor under one condition.
struct AmbiguityRow {
  std::string floor;
  std::string condition;
  int tiles = 0;
  double map_rms_m = 0.0;  ///< position error of the map's own frames
  FrameScore frames;
  std::vector<StartScore> starts;  ///< one per method
};

/// Prints two Markdown tables, of cold starts and of frames, and a legend. methods: names, as in AmbiguityRow::starts.
void PrintAmbiguity(std::ostream& out, const std::vector<std::string>& methods, const std::vector<AmbiguityRow>& rows);
/// The same as pretty-printed JSON.
std::string ToJson(const std::vector<std::string>& methods, const std::vector<AmbiguityRow>& rows);

}  // namespace floorloc
