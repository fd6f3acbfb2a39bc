// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unordered_map>
#include <vector>

#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

/// Deformation of a map whose frames get new poses: the motions of nearby frames, weighted by distance.
class MapDeformation {
 public:
  MapDeformation(const BaseMap& map, const std::vector<Pose2>& new_from_base);

  /// new_from_old at a point of the old frame.
  Pose2 At(const Eigen::Vector2d& point_in_old) const;
  /// Inverse: position in the old frame of a point in the new one.
  Eigen::Vector2d OldFromNew(const Eigen::Vector2d& point_in_new) const;

 private:
  struct LocalMotion {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  // of the frame's view, old frame
    Pose2 new_from_old;
  };
  using Cells = std::unordered_map<std::int64_t, std::vector<int>>;

  Pose2 InterpolateNear(const Eigen::Vector2d& point, const Cells& cells, bool in_new) const;

  std::vector<LocalMotion> local_motions_;
  Cells old_cells_, new_cells_;  // of the centers
  double cell_m_ = 1.0;
};

}  // namespace floorloc
