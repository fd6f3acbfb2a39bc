// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/common/extractor_tally.h"
#include "tests/bench/keypoints/pruning_rule.h"
#include "tests/bench/scenes/scene.h"

namespace floorloc {

/// A row of the table: results over the maps of one rule and budget.
struct KeypointTally {
  PruningRule rule = PruningRule::kUseful;
  double budget_per_m2 = 0.0;
  std::size_t keypoints = 0;   ///< of all maps
  std::size_t file_bytes = 0;  ///< of all map files without their mosaics
  double area_m2 = 0.0;        ///< of all maps
  std::map<std::string, GroupTally> groups;
};

/// Builds the scene's map in the folder. For every tally, fuses its keypoints again with the tally's rule and budget,
/// localizes the scene's frames with them on all cores and adds the results to the tally; `advance` is called after
/// each. Throws the builder's exceptions.
void TryBudgets(const Scene& scene, const std::filesystem::path& folder, std::vector<KeypointTally>* tallies,
                const std::function<void()>& advance);

}  // namespace floorloc
