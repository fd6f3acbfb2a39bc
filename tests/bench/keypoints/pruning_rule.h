// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/keypoints/fuse_keypoints.h"

namespace floorloc {

/// How a map that must be smaller chooses its keypoints.
enum class PruningRule {
  kUseful,    ///< the product's: repeat rate times distinctiveness, cells filled like water
  kObserved,  ///< most observations, then the strongest; every cell the same hard limit (the builder's first rule)
  kRandom,    ///< any, cells filled like water
};

const char* ToString(PruningRule rule);
const std::vector<PruningRule>& AllPruningRules();

/// A map's keypoints, chosen by the rule within options.pruning's budget.
MapKeypoints FuseByRule(PruningRule rule, const KeypointFusionInput& input, const KeypointFusionOptions& options);

}  // namespace floorloc
