// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The tables of a map file. Whatever they hold, what comes back is consistent: every index names something that is
// there, every number is finite and within reason. Else each throws a MapError (damaged) that names table, row and
// column.

/// What the map says about itself: map, parent, extractor_parameter, camera.
MapInfo ReadInfoTables(const SqliteConnection& connection);
/// All look at the surveyed floor.
std::vector<MapFrame> ReadFrameTable(const SqliteConnection& connection, const MapInfo& info);
/// frames: how many there are.
std::vector<MapLink> ReadLinkTable(const SqliteConnection& connection, const MapInfo& info, int frames);

MosaicLayout ReadMosaicColumns(const SqliteConnection& connection);
/// Of one level; all lie on the surveyed floor.
std::vector<TileId> ReadMosaicTileIds(const SqliteConnection& connection, int zoom);

}  // namespace floorloc
