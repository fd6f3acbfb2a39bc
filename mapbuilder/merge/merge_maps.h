// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/merge/align_maps.h"

namespace floorloc {

struct MergeOptions {
  std::filesystem::path first;   ///< gives the merged map its frame and its id
  std::filesystem::path second;  ///< where both have floor, the first's mosaic is shown
  std::filesystem::path out;     ///< may be one of them
  MapAlignmentOptions alignment;
  int jpeg_quality = 90;
};

struct MergeReport {
  int frames = 0;              ///< of the merged map
  int shared_frames = 0;       ///< of the second map, that see floor of the first
  double deformation_m = 0.0;  ///< largest displacement of one of the second map's frames beyond the rigid motion
  int keypoints = 0;
  int shared_keypoints = 0;  ///< floor points that both maps had
  double area_m2 = 0.0;
  std::string content_version;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Two maps -> one. Throws MapError when they have other features or resolutions, or do not overlap.
MergeReport MergeMaps(const MergeOptions& options);

}  // namespace floorloc
