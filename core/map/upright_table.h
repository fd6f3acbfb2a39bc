// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The table keypoint_upright: the layer of upright descriptors.

/// Writes MapKeypoints::upright in the tiles of the table of keypoints, which have the given side. Nothing when empty.
void WriteUpright(const SqliteConnection& connection, const MapKeypoints& keypoints, double tile_m);

/// One row per keypoint, in the order in which ReadKeypointTable() returns them. Throws a MapError (damaged) that names
/// the tile.
cv::Mat ReadUpright(const SqliteConnection& connection, std::size_t keypoints);

}  // namespace floorloc
