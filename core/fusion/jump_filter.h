// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/geometry/pose2.h"

namespace floorloc {

struct JumpFilterOptions {
  double max_distance_m = 0.20;
  double max_angle_rad = 0.17453292519943295;  ///< 10 degrees

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Drops poses that jump from the last accepted one by more than a distance or an angle. The first pose is always
/// accepted: when it is wrong, all right ones after it are dropped, as in the thesis.
class JumpFilter {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit JumpFilter(const JumpFilterOptions& options);

  /// With odometry the jump is measured from the last accepted pose propagated by odometry.
  bool Accept(const Pose2& map_from_base, const std::optional<Pose2>& odom_from_base);
  const JumpFilterOptions& options() const { return options_; }

 private:
  JumpFilterOptions options_;
  std::optional<Pose2> last_map_from_base_;
  std::optional<Pose2> last_odom_from_base_;
};

}  // namespace floorloc
