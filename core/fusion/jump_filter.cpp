// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/jump_filter.h"

#include <cmath>

namespace floorloc {

bool JumpFilter::Accept(const Pose2& map_from_base, const std::optional<Pose2>& odom_from_base) {
  if (last_map_from_base_) {
    const Pose2 moved =
        last_odom_from_base_ && odom_from_base ? last_odom_from_base_->Between(*odom_from_base) : Pose2();
    const Pose2 jump = (*last_map_from_base_ * moved).Between(map_from_base);
    if (jump.translation().norm() > options_.max_distance_m || std::abs(jump.yaw()) > options_.max_angle_rad) {
      return false;
    }
  }
  last_map_from_base_ = map_from_base;
  last_odom_from_base_ = odom_from_base;
  return true;
}

}  // namespace floorloc
