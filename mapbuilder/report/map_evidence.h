// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_report.h"
#include "mapbuilder/report/camera_copies.h"

namespace floorloc {

/// Data of the map file on which the report is based.
struct MapEvidence {
  FloorMap map;
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
  BuildReport build;                 ///< times are not in the map
  std::vector<CameraCopies> copies;  ///< what moved with a camera and is in the mosaic

  const RectM& RoiOf(const MapFrame& frame) const {
    return map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi;
  }
};

/// Where the report's drawings have (0, 0): map frame, metres.
inline Eigen::Vector2d DrawingOrigin(const MapEvidence& evidence) { return evidence.map.keypoints.origin_m; }

/// Extent of the surveyed floor and of dropped frames, unless they are much farther away.
RectM ExtentWithLostFrames(const MapEvidence& evidence);

/// Throws MapError.
MapEvidence ReadMapEvidence(const MapDatabase& database);

}  // namespace floorloc
