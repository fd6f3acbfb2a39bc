// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

struct TieOptions {
  bool same_frame = false;  ///< the maps live in one frame already; they need not overlap
  int threads = 0;          ///< 0: one per core
  std::uint32_t seed = 1;
  ProgressOutput progress;
};

/// One map laid on another.
struct MapTie {
  std::vector<Pose2> first_from_base;  ///< of each frame of the second map, in the first one's frame
  int shared_frames = 0;               ///< of them, that see floor of the first map
  double bent_m = 0.0;                 ///< how far a frame moved beyond the rigid motion, at most
};

/// Finds where the second map lies in the first by what its frames see: most of those that are found must agree on one
/// rigid motion. Then the second map's frames are bent onto the first where they overlap, held together by its links.
/// Throws MapError when the maps don't overlap enough, or disagree.
MapTie TieMaps(const OldMap& first, const OldMap& second, const TieOptions& options);

}  // namespace floorloc
