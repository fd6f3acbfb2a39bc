// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/placement/pair_selection.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct SimilarPairsOptions {
  int pairs_per_frame = 6;  ///< with frames of each other part
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Pairs of frames of different parts, by appearance alone: those whose keypoints are most often each other's nearest
/// neighbours. part: one number per frame. Near-linear in the number of frames: one index over all frames and one over
/// each large part, so that a frame's own part does not crowd out the others.
std::vector<FramePair> SelectSimilarPairs(const std::vector<BuildFrame>& frames, const std::vector<int>& part,
                                          const SimilarPairsOptions& options);

}  // namespace floorloc
