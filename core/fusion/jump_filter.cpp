// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/jump_filter.h"

#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {

void JumpFilterOptions::Check() const {
  RequireOption(max_distance_m > 0.0, "max_distance_m must be positive");
  RequireOption(max_angle_rad > 0.0, "max_angle_rad must be positive");
}

JumpFilter::JumpFilter(const JumpFilterOptions& options) : options_(options) { options_.Check(); }

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
