// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

/// All tiles of keypoints, every blob's length and checksum verified, every number within reason, every survey one of
/// the `info`'s. Throws a MapError (damaged) that names the tile.
MapKeypoints ReadKeypointTable(const SqliteConnection& connection, const MapInfo& info);

}  // namespace floorloc
