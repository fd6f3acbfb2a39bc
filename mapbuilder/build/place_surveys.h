// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/build/build_options.h"

namespace floorloc {

/// Frames with poses, and what was found on the way.
struct PlacedSurveys {
  FrameSet set;
  Placement placement;
  std::optional<MarkerSurvey> markers;  ///< empty: none were searched for
  std::string base_file = {};           ///< name of the base map; empty: none
  /// By which known lengths changed the height of every frame; empty: there were none, or all frames have one height.
  std::optional<double> height_factor = {};
  int found_in_base = 0;                   ///< frames that were localized in the base map
  std::vector<std::string> warnings = {};  ///< about base map and control points, one sentence each
};

/// Computes poses of the screened frames from their images and all external knowledge: poses of another system,
/// markers, the base map (nullptr: none). Reuses what an earlier run left in the journal. Throws InputError.
PlacedSurveys PlaceSurveys(FrameSet set, const BuildOptions& options, const BaseMap* base, BuildJournal* journal);

}  // namespace floorloc
