// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// The table floor_lattice: the layer of that name.

void WriteFloorLattices(const SqliteConnection& connection, const std::vector<MapLattice>& lattices);

/// The regions in which the floor repeats itself. Throws a MapError (damaged) that names row and column.
std::vector<MapLattice> ReadFloorLattices(const SqliteConnection& connection);

}  // namespace floorloc
