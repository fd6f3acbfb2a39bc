// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/lattice/lattice_regions.h"
#include "mapbuilder/merge/align_maps.h"

namespace floorloc {

struct MergeOptions {
  std::filesystem::path first;   ///< determines frame and id of the merged map
  std::filesystem::path second;  ///< where both have floor, the first map's mosaic is shown
  std::filesystem::path out;     ///< may equal one of them
  MapAlignmentOptions alignment;
  LatticeRegionOptions lattices;
  int jpeg_quality = 90;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

struct MergeReport {
  int frames = 0;              ///< of the merged map
  int shared_frames = 0;       ///< frames of the second map that show floor of the first
  double deformation_m = 0.0;  ///< largest displacement of a frame of the second map beyond the rigid motion
  int keypoints = 0;
  int shared_keypoints = 0;  ///< floor points found in both maps
  double area_m2 = 0.0;
  std::vector<MapLattice> lattices;  ///< where the floor repeats itself
  std::string content_version;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Merges two maps. Throws MapError when their features or resolutions differ or they do not overlap.
MergeReport MergeMaps(const MergeOptions& options);

}  // namespace floorloc
