// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_report.h"

namespace floorloc {

/// All that a report rests on, as the map file has it.
struct MapEvidence {
  FloorMap map;
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
  BuildReport build;  ///< times are not in a map

  const RectM& RoiOf(const MapFrame& frame) const {
    return map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi;
  }
};

/// The surveyed floor and, as far as it is not much farther away, where frames were left out.
RectM ExtentWithLostFrames(const MapEvidence& evidence);

/// Throws MapError.
MapEvidence ReadMapEvidence(const MapDatabase& database);

}  // namespace floorloc
