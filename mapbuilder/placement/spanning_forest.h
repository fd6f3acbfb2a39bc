// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/link.h"

namespace floorloc {

/// Connected component of every frame under the given links, numbered 0, 1, ... by smallest frame.
std::vector<int> FindComponents(int frame_count, const std::vector<Link>& links);

/// Initial poses by chaining the links of a maximum spanning forest: `links` first (most inliers first), then
/// `odometry` where it joins what they leave separate. The first frame of each tree gets its pose from `root_pose`.
std::vector<Pose2> ChainPoses(const std::vector<Pose2>& root_pose, const std::vector<Link>& links,
                              const std::vector<Link>& odometry);

}  // namespace floorloc
