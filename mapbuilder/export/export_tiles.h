// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/map/map_database.h"

namespace floorloc {

/// Writes the mosaic's tiles as they are in the map, FOLDER/z/x/y.jpg with y counting up, and FOLDER/metadata.json,
/// which says where they lie. The folder appears when it is complete. Returns the number of tiles. Throws MapError or
/// InputError.
std::int64_t ExportTiles(const MapDatabase& map, const std::filesystem::path& folder);

}  // namespace floorloc
