// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/map/map_database.h"

namespace floorloc {

struct GeoTiffSummary {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  double resolution_m = 0.0;
};

/// Writes a level of the mosaic, the coarsest that is at least as fine as asked for (0: the finest), as a tiled GeoTIFF
/// (OGC 19-008r4) in a local engineering coordinate system in metres, the map frame. The map's JPEG tiles go into it as
/// they are, one by one: nothing is compressed twice, and memory does not grow with the floor. BigTIFF where 4 GiB
/// might not do. Throws MapError or InputError.
GeoTiffSummary ExportGeoTiff(const MapDatabase& map, double resolution_m, const std::filesystem::path& file);

}  // namespace floorloc
