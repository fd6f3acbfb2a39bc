// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/bench/floor_check/strange_views.h"
#include "tests/bench/scenes/scene.h"

namespace floorloc {

/// Results of some images, each localized by a localizer that searches for every view and by one that looks at its
/// texture first.
struct FloorRow {
  std::string map;
  std::string views;
  int images = 0;
  int found_before = 0;  ///< localized, wherever
  int found_after = 0;
  int no_floor_refused = 0;  ///< before the search
  int other_floor_refused = 0;
  int no_floor_named = 0;  ///< after a search in vain
  int other_floor_named = 0;
  double before_ms = 0.0;   ///< median time after the features, of those that were not localized
  double refused_ms = 0.0;  ///< median time of those that were refused
};

/// Builds the map of a scene, and tries its own frames, also blurred ones, and the strange views.
std::vector<FloorRow> TryFloor(const std::string& name, const Scene& scene, const std::vector<StrangeViews>& strange,
                               const std::filesystem::path& map_file);

}  // namespace floorloc
