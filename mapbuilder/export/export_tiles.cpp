// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_tiles.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/batch/pending_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// Files need not be written atomically, since the whole folder is renamed at the end.
void WriteTile(const fs::path& file, const std::vector<std::uint8_t>& jpeg) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
  if (!out.flush()) {
    throw InputError(file, "cannot be written; check the permissions and the free space");
  }
}

nlohmann::ordered_json Describe(const MapInfo& info, const MosaicLayout& layout) {
  nlohmann::ordered_json json = {
      {"map", info.name},
      {"version", info.content_version},
      {"frame", "map"},
      {"tile_px", layout.tile_px},
      {"format", "jpg"},
      {"x_axis", "tile x covers [x, x + 1) * tile_m of the map frame's x"},
      {"y_axis", "tile y covers [y, y + 1) * tile_m of the map frame's y, upwards"},
      {"extent", {info.extent.x_min, info.extent.y_min, info.extent.x_max, info.extent.y_max}}};
  for (int zoom = 0; zoom <= layout.max_zoom; ++zoom) {
    const double side_m = layout.TileSide(zoom);
    json["levels"].push_back({{"z", zoom}, {"resolution_m", side_m / layout.tile_px}, {"tile_m", side_m}});
  }
  return json;
}

}  // namespace

std::int64_t ExportTiles(const MapDatabase& map, const fs::path& folder) {
  const MosaicLayout layout = map.ReadMosaicLayout();
  PendingFolder pending(folder);
  std::int64_t count = 0;
  for (int zoom = 0; zoom <= layout.max_zoom; ++zoom) {
    for (const TileId& tile : map.ListMosaicTiles(zoom)) {
      const auto jpeg = map.ReadMosaicTile(tile);
      if (!jpeg) {
        throw MapError("a mosaic tile is missing; restore the map from a copy or build it again");
      }
      const std::string name = std::to_string(tile.y) + ".jpg";
      WriteTile(pending.path() / std::to_string(tile.z) / std::to_string(tile.x) / name, *jpeg);
      ++count;
    }
  }
  WriteFileAtomically(
      pending.path() / "metadata.json",
      Describe(map.ReadInfo(), layout).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  pending.Complete();
  return count;
}

}  // namespace floorloc
