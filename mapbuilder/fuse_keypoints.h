// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/survey_frames.h"

namespace floorloc {

/// Lengths and budget are for the sample camera (0.7 mm per pixel, 0.13 m2 in view, 700 keypoints); ForCamera() adapts
/// them to others.
struct FusionOptions {
  double radius_m = 1.2e-3;  ///< views of one floor point lie this close
  double angle_rad = 0.35;
  double max_binary_share = 0.22;  ///< differing bits of two views, share of all
  double max_float_share = 0.55;   ///< distance of two views, share of the descriptor's norm
  int min_coverage = 3;            ///< where as many frames look, a point that one alone saw is dropped
  double max_per_m2 = 6000.0;      ///< budget
  double budget_cell_m = 0.1;      ///< cells that share it

  FusionOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;
};

/// Keypoints of overlapping frames become map points: positions and angles averaged, descriptors by majority (binary)
/// or mean (float), number of observations counted; weak ones dropped, evenly over the floor.
MapKeypoints FuseKeypoints(const std::vector<BuildFrame>& frames,
                           const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base, const FusionOptions& options);

}  // namespace floorloc
