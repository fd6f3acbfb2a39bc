// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/finished_map/base_map.h"
#include "mapbuilder/mosaic/exposure.h"
#include "mapbuilder/placement/place_frames.h"

namespace floorloc {

/// Placed frames and their links as stored in the map file; dropped frames get no number.
struct MapFramesAndLinks {
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
};

/// With a base map (nullptr: none) its frames, links and surveys come first.
MapFramesAndLinks CollectMapFrames(const std::vector<BuildFrame>& frames, const Placement& placement,
                                   const Exposure& exposure, const BaseMap* base_map);

}  // namespace floorloc
