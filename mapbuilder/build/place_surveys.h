// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/build/build_options.h"

namespace floorloc {

/// Frames with poses, and what was seen on the way to them.
struct PlacedSurveys {
  FrameSet set;
  Placement placement;
  std::optional<MarkerSurvey> markers;     ///< empty: none were sought
  std::string base_file = {};              ///< name of the base map; empty: none
  int found_in_base = 0;                   ///< frames that show its floor
  std::vector<std::string> warnings = {};  ///< about the base map, sentences
};

/// Screened frames -> poses, with everything that is known of them from outside: the poses of another system, markers,
/// the base map (nullptr: none). What an earlier run left in the journal is not done again. Throws InputError.
PlacedSurveys PlaceSurveys(FrameSet set, const BuildOptions& options, const BaseMap* base, BuildJournal* journal);

}  // namespace floorloc
