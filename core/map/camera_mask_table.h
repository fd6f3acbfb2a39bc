// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The table camera_mask: the layer of that name.

/// Writes the masks of the surveys that have one.
void WriteCameraMasks(const SqliteConnection& connection, const MapInfo& info);

/// One mask per camera, empty where the table has none. Throws a MapError (damaged) that names row and column.
std::vector<MapCameraMask> ReadCameraMasks(const SqliteConnection& connection, const MapInfo& info);

/// The mask of a camera that has the calibration of one of the map's surveys: of the newest such survey with a mask;
/// CV_8UC1 of the camera's size, 0 where it sees no floor. Empty for other cameras and without a mask.
cv::Mat MaskOfCamera(const MapInfo& info, const FloorCamera& camera);

}  // namespace floorloc
