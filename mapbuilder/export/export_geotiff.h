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

/// Writes a level of the mosaic, the coarsest that is at least as fine as resolution_m (0: the finest), as a tiled
/// GeoTIFF (OGC 19-008r4) in a local engineering coordinate system in metres, the map frame. The map's JPEG tiles are
/// copied one by one without re-encoding, so that memory does not grow with the floor. Floor that was not surveyed is
/// no data: a transparency mask (TIFF 6.0, new subfile type 4), as GDAL and QGIS read it, says which pixels are floor.
/// Uses BigTIFF when the file might exceed 4 GiB. Throws MapError or InputError.
GeoTiffSummary ExportGeoTiff(const MapDatabase& map, double resolution_m, const std::filesystem::path& file);

}  // namespace floorloc
