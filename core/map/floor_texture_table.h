// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The table floor_texture: the layer of that name.

/// Writes the models of the surveys that have one.
void WriteFloorTextures(const SqliteConnection& connection, const MapInfo& info);

/// One model per survey, with blocks 0 where the table has none. Throws a MapError (damaged) that names row and column.
std::vector<MapFloorTexture> ReadFloorTextures(const SqliteConnection& connection, const MapInfo& info);

}  // namespace floorloc
