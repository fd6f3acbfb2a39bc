// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Which frames cover a place: a spatial hash, whose queries take as long for 20,000 frames as for 20.
class FrameIndex {
 public:
  /// Frames without a pose are left out. floor_in_base: what each frame sees of the floor.
  FrameIndex(const std::vector<std::optional<Pose2>>& map_from_base, const std::vector<RectM>& floor_in_base);

  /// Frames whose floor's bounding box touches the rectangle (map frame), in ascending order.
  std::vector<int> Touching(const RectM& rect) const;

 private:
  double cell_m_ = 1.0;
  std::vector<Eigen::AlignedBox2d> boxes_;  // map frame; empty without a pose
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace floorloc
