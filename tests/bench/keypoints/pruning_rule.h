// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/keypoints/fuse_keypoints.h"

namespace floorloc {

/// Rule by which a map with a keypoint budget chooses its keypoints.
enum class PruningRule {
  kUseful,    ///< the builder's: repeat rate times distinctiveness, cells filled evenly (water filling)
  kObserved,  ///< most observations, then response; the same hard limit for every cell (the builder's first rule)
  kRandom,    ///< random, cells filled evenly (water filling)
};

const char* ToString(PruningRule rule);
const std::vector<PruningRule>& AllPruningRules();

/// The fused keypoints, chosen by the rule within options.pruning's budget.
MapKeypoints FuseByRule(PruningRule rule, const KeypointFusionInput& input, const KeypointFusionOptions& options);

}  // namespace floorloc
