// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Two frames that may show the same floor; first < second.
struct FramePair {
  int first = 0;
  int second = 0;
  std::optional<Pose2> first_from_second;  ///< predicted pose of the second in the first
  double radius_m = 0.0;                   ///< of the predicted position
  double yaw_radius_rad = 0.0;
};

/// Consecutive frames of each survey, with the motion from odometry where available.
std::vector<FramePair> SelectConsecutivePairs(const std::vector<BuildFrame>& frames);

struct NearbyOptions {
  double min_overlap = 0.25;  ///< share of the second frame's floor inside the first's
  double radius_m = 0.1;      ///< uncertainty of the poses
  double yaw_radius_rad = 0.15;
  int first_new = 0;  ///< only pairs with a frame of this index or later

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Pairs of placed frames whose floors overlap, found through a spatial hash: linear in the number of frames.
std::vector<FramePair> SelectNearbyPairs(const std::vector<std::optional<Pose2>>& map_from_base,
                                         const std::vector<RectM>& floor_in_base, const NearbyOptions& options);

/// Share of the second rectangle inside the first.
double OverlapShare(const RectM& first, const RectM& second, const Pose2& first_from_second);

}  // namespace floorloc
