// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/map/map_database.h"

namespace floorloc {

/// A number or name that differs between two maps.
struct Difference {
  std::string name, before, after;
};

/// Motion of the frames that are in both maps.
struct FrameMoves {
  double rms_m = 0.0;
  double max_m = 0.0;
  double max_rad = 0.0;
  std::string farthest;  ///< file name of the frame that moved max_m
  Pose2 farthest_pose;   ///< in the first map
};

/// Differences between two maps, which are assumed to share one frame, as versions of one map do.
struct MapDiff {
  /// "same content", "extends", "merges" (the second was made from the first), "is extended by", "is merged into" (the
  /// reverse), "another version" (same id) or "another map".
  std::string relation;
  double before_m2 = 0.0;
  double after_m2 = 0.0;
  double gained_m2 = 0.0;  ///< floor of the second map more than a cell of 2 cm away from the first's
  double lost_m2 = 0.0;
  int frames_kept = 0;  ///< matched by survey, file name and stamp, each frame once
  int frames_removed = 0;
  int frames_added = 0;
  FrameMoves moves;  ///< of the kept frames
  /// By position and descriptor; empty when the maps' descriptors are not comparable.
  struct Keypoints {
    int kept = 0;
    int gone = 0;
    int added = 0;
  };
  std::optional<Keypoints> keypoints;
  std::vector<Difference> parameters;  ///< extractor, cameras of surveys with the same name, mosaic, builder
};

MapDiff CompareMaps(const MapDatabase& before, const MapDatabase& after);

}  // namespace floorloc
