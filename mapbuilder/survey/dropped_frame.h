// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Reason of a frame that repeats the one before it: its floor is in the map all the same.
inline constexpr const char* kStoodStill = "the robot stood still";

/// A frame that is not in the map.
struct DroppedFrame {
  std::string filename;
  std::string reason;
  std::optional<Pose2> near = {};  ///< approximate map_from_base, by odometry; empty: unknown
  int survey = 0;
  std::optional<std::int64_t> stamp_ns = {};
};

}  // namespace floorloc
