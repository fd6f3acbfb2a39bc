// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// Formats the pose graph as g2o text (Kuemmerle et al. 2011): VERTEX_SE2 per frame, numbered in order, EDGE_SE2 per
/// link with the upper triangle of its information matrix, FIX for the first frame.
std::string FormatG2o(const std::vector<MapFrame>& frames, const std::vector<MapLink>& links);

}  // namespace floorloc
