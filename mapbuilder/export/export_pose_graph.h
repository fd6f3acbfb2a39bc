// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// The pose graph in g2o's text format (Kuemmerle et al. 2011): VERTEX_SE2 per frame, numbered in their order,
/// EDGE_SE2 per link with the upper triangle of its information, FIX for the first frame.
std::string FormatG2o(const std::vector<MapFrame>& frames, const std::vector<MapLink>& links);

}  // namespace floorloc
