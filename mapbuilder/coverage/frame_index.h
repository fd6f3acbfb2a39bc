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

/// Spatial hash of the frames that cover a place; query time is independent of the number of frames.
class FrameIndex {
 public:
  /// Frames without a pose are ignored. floor_in_base: floor in each frame's view.
  FrameIndex(const std::vector<std::optional<Pose2>>& map_from_base, const std::vector<RectM>& floor_in_base);

  /// Frames whose floor's bounding box touches the rectangle (map frame), in ascending order.
  std::vector<int> Touching(const RectM& rect) const;

 private:
  double cell_m_ = 1.0;
  std::vector<Eigen::AlignedBox2d> boxes_;  // map frame; empty without a pose
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace floorloc
