// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

struct MapAlignmentOptions {
  bool same_frame = false;  ///< the maps live in one frame already; they need not overlap
  int threads = 0;          ///< 0: one per core
  std::uint32_t seed = 1;
  ProgressOutput progress;
};

/// One map aligned to another.
struct MapAlignment {
  std::vector<Pose2> first_from_base;  ///< of each frame of the second map, in the first one's frame
  int shared_frames = 0;               ///< of them, that see floor of the first map
  double deformation_m = 0.0;          ///< largest displacement of a frame beyond the rigid motion
};

/// Localizes the second map's frames in the first: most of those that are found must agree on one rigid motion. Then
/// the second map's pose graph is optimized with them as priors, which deforms it onto the first where they overlap.
/// Throws MapError when the maps don't overlap enough, or disagree.
MapAlignment AlignMaps(const BaseMap& first, const BaseMap& second, const MapAlignmentOptions& options);

}  // namespace floorloc
