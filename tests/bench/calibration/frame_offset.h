// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// What no image can tell of a map and a camera: scale, place and heading of the map frame, and the place and heading
/// of the base frame in the robot.
struct FrameOffset {
  double scale = 1.0;
  Pose2 truth_from_map;  ///< after scaling
  Pose2 base_from_camera_base;

  /// A pose in the map, as the truth has it.
  Pose2 Apply(const Pose2& map_from_base) const;
};

/// A pose and its truth.
struct PoseAndTruth {
  Pose2 map_from_base;
  Pose2 truth_from_base;
};

/// All of the offset by least squares (Gauss-Newton); a yaw counts like 0.25 m of lever. The base frame's offset is
/// zero when all poses have one heading. Throws std::invalid_argument for fewer than three poses.
FrameOffset FitFrameOffset(const std::vector<PoseAndTruth>& poses);

/// Only the base frame's offset, robust: the medians over the poses of a vehicle whose map's frame is known. Unchanged
/// without poses.
FrameOffset FitBaseOffset(const std::vector<PoseAndTruth>& poses, FrameOffset map);

}  // namespace floorloc
