// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/io/trajectory.h"
#include "mapbuilder/heights/scale_registration.h"

namespace floorloc {

/// Moves the log heights of each group of linked frames to the scale of the poses of another system or, without them,
/// of the odometry: the median over the links. Groups without such motions keep their mean height. Returns how many
/// groups of more than one frame were moved, and how many there are.
struct ScaledGroups {
  int moved = 0;
  int all = 0;
};
ScaledGroups ScaleByMotion(const FrameSet& set, const Trajectory& poses, const std::vector<ScaleLink>& links,
                           std::vector<double>* log_height);

/// Known lengths on the floor over those that the placed frames show: the median over known distances and pairs of
/// control points. Empty: the surveys have none.
std::optional<double> ScaleByKnownLengths(const FrameSet& set, const std::vector<std::optional<Pose2>>& map_from_base);

/// Multiplies the height of every frame, and moves its keypoints accordingly.
void MultiplyHeights(double factor, FrameSet* set);

}  // namespace floorloc
