// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/place_frames.h"

namespace floorloc {

/// The placement that an optimised graph gives: the parts that images connect and whose position is known are kept (the
/// largest when none is; keep_all: all of at least two frames), the other frames get the reason why they are dropped.
/// floors: region of interest of each frame, base frame. Also link statistics and drift. Throws InputError when no two
/// frames are connected.
Placement PlaceConnectedParts(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floors,
                              const PoseGraph& graph, bool keep_all);

}  // namespace floorloc
