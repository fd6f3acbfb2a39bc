// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

struct MapAlignmentOptions {
  bool same_frame = false;  ///< the maps already share one frame; they need not overlap
  RunOptions run;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Alignment of a second map to a first.
struct MapAlignment {
  std::vector<Pose2> first_from_base;  ///< of each frame of the second map, in the first map's frame
  int shared_frames = 0;               ///< number of those that show floor of the first map
  double deformation_m = 0.0;          ///< largest displacement of a frame beyond the rigid motion
};

/// Localizes the second map's frames in the first; most fixes must agree on one rigid motion. Then optimizes the second
/// map's pose graph with the fixes as priors, which deforms it onto the first where they overlap. Throws MapError when
/// the maps overlap too little or are inconsistent.
MapAlignment AlignMaps(const BaseMap& first, const BaseMap& second, const MapAlignmentOptions& options);

}  // namespace floorloc
