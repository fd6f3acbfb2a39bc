// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/map/map_database.h"

namespace floorloc {

/// Copies the mosaic's tiles to FOLDER/z/x/y.jpg, y increasing upwards, and writes FOLDER/metadata.json with their
/// georeference. The folder appears only when complete. Returns the number of tiles. Throws MapError or InputError.
std::int64_t ExportTiles(const MapDatabase& map, const std::filesystem::path& folder);

}  // namespace floorloc
