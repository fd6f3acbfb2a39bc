// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

/// Reads all tiles of keypoints and verifies length and checksum of every blob, the range of every number, and that
/// every survey is in `info`. Throws a MapError (damaged) that names the tile.
MapKeypoints ReadKeypointTable(const SqliteConnection& connection, const MapInfo& info);

}  // namespace floorloc
