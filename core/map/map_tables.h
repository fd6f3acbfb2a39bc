// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// Readers of the tables of a map file. They return consistent data (every index valid, every number finite and within
// its range) or throw a MapError (damaged) that names table, row and column.

/// Metadata of the map: tables map, parent, extractor_parameter, camera.
MapInfo ReadInfoTables(const SqliteConnection& connection);
/// All frames see surveyed floor.
std::vector<MapFrame> ReadFrameTable(const SqliteConnection& connection, const MapInfo& info);
/// frames: how many there are.
std::vector<MapLink> ReadLinkTable(const SqliteConnection& connection, const MapInfo& info, int frames);

MosaicLayout ReadMosaicColumns(const SqliteConnection& connection);
/// The encoded JPEG of a mosaic tile, its checksum verified; empty where the map has none.
std::optional<std::vector<std::uint8_t>> ReadTile(const SqliteConnection& connection, const TileId& tile);
/// Tiles of one level, all on the surveyed floor.
std::vector<TileId> ReadMosaicTileIds(const SqliteConnection& connection, int zoom);

}  // namespace floorloc
