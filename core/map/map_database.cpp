// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_database.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <string>

#include "core/map/checked_row.h"
#include "core/map/keypoint_table.h"
#include "core/map/map_contract.h"
#include "core/map/map_layers.h"
#include "core/map/map_tables.h"
#include "core/map/upright_table.h"
#include "core/vision/extractors/extractor_layout.h"

namespace floorloc {
namespace {

constexpr int kMaxBlobBytes = 512 << 20;

SqliteConnection OpenChecked(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw MapError(file.string() + " does not exist or is not a file; give the path of a .floormap file");
  }
  SqliteConnection connection(file, SqliteConnection::Mode::kReadOnly);
  // A map is untrusted input: nothing in it may run code or exceed limits (SQLite, "Defense Against The Dark Arts").
  sqlite3_db_config(connection.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(connection.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(connection.get(), SQLITE_LIMIT_LENGTH, kMaxBlobBytes);
  connection.Execute("PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;");
  return connection;
}

std::int64_t Pragma(const SqliteConnection& connection, const char* name) {
  SqliteStatement statement(connection, std::string("PRAGMA ") + name);
  return statement.Step() ? statement.Integer(0) : 0;
}

}  // namespace

struct MapDatabase::Impl {
  explicit Impl(const std::filesystem::path& file) : connection(OpenChecked(file)) { CheckContract(); }

  SqliteConnection connection;
  mutable std::mutex mutex;

  void CheckContract() const;
  std::vector<MapFrame> ReadFrames() const { return ReadFrameTable(connection, ReadInfoTables(connection)); }
  std::vector<MapLink> ReadLinks() const {
    return ReadLinkTable(connection, ReadInfoTables(connection), Count("frame"));
  }
  void CheckMosaicTileIds() const;
  int Count(const std::string& table) const;
};

void MapDatabase::Impl::CheckContract() const {
  if (Pragma(connection, "application_id") != kMapApplicationId) {
    throw MapError(
        connection.file().string() + " is not a floorloc map; give a .floormap file that floorloc-mapbuilder wrote",
        MapError::Kind::kDamaged);
  }
  const int version = ReadFormatVersion(connection);
  if (version < kOldestMapFormatVersion || version > kMapFormatVersion) {
    throw MapError(connection.file().string() + " has format version " + std::to_string(version) +
                       " but this program reads versions " + std::to_string(kOldestMapFormatVersion) + " to " +
                       std::to_string(kMapFormatVersion) +
                       "; build the map again or use the matching version of floorloc",
                   MapError::Kind::kUnsupported);
  }
  SqliteStatement check(connection, "PRAGMA quick_check(1)");
  if (std::string found = check.Step() ? check.Text(0) : "no answer"; found != "ok") {
    std::replace(found.begin(), found.end(), '\n', ' ');
    ThrowDamaged(connection, "SQLite's quick_check: " + found);
  }
  // Untrusted input: views, triggers and virtual tables could compute without end.
  SqliteStatement code(connection,
                       "SELECT COUNT(*) FROM sqlite_schema WHERE type NOT IN ('table', 'index') "
                       "OR sql LIKE 'CREATE VIRTUAL%'");
  if (!code.Step() || code.Integer(0) > 0) {
    ThrowDamaged(connection, "it holds more than tables");
  }
  ReadLayers(connection);
}

int MapDatabase::Impl::Count(const std::string& table) const {
  SqliteStatement count(connection, "SELECT COUNT(*) FROM " + table);
  const std::int64_t rows = count.Step() ? count.Integer(0) : 0;
  if (rows > std::numeric_limits<int>::max()) {
    ThrowDamaged(connection, table + ": more rows than can be numbered");
  }
  return static_cast<int>(rows);
}

void MapDatabase::Impl::CheckMosaicTileIds() const {
  const int max_zoom = ReadMosaicColumns(connection).max_zoom;
  std::size_t listed = 0;
  for (int zoom = 0; zoom <= max_zoom; ++zoom) {
    listed += ReadMosaicTileIds(connection, zoom).size();
  }
  if (listed != static_cast<std::size_t>(Count("mosaic_tile"))) {
    ThrowDamaged(connection, "mosaic_tile: tiles of levels that the mosaic does not have");
  }
}

MapDatabase::MapDatabase(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}

MapDatabase::~MapDatabase() = default;

MapInfo MapDatabase::ReadInfo() const {
  const std::lock_guard lock(impl_->mutex);
  return ReadInfoTables(impl_->connection);
}

MosaicLayout MapDatabase::ReadMosaicLayout() const {
  const std::lock_guard lock(impl_->mutex);
  return ReadMosaicColumns(impl_->connection);
}

FloorMap MapDatabase::ReadMap() const {
  const std::lock_guard lock(impl_->mutex);
  FloorMap map;
  map.info = ReadInfoTables(impl_->connection);
  map.mosaic = ReadMosaicColumns(impl_->connection);
  map.keypoints = ReadKeypointTable(impl_->connection, map.info);
  if (HasLayer(map.info.layers, kUprightLayer) && HasUpright(map.info.extractor.type)) {
    map.keypoints.upright = ReadUpright(impl_->connection, map.keypoints.size());
  }
  // Not returned, but a map is used only when all of it is valid.
  impl_->ReadFrames();
  impl_->ReadLinks();
  impl_->CheckMosaicTileIds();
  return map;
}

std::vector<MapFrame> MapDatabase::ReadFrames() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadFrames();
}

std::vector<MapLink> MapDatabase::ReadLinks() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadLinks();
}

std::optional<std::vector<std::uint8_t>> MapDatabase::ReadMosaicTile(const TileId& tile) const {
  const std::lock_guard lock(impl_->mutex);
  return ReadTile(impl_->connection, tile);
}

std::vector<TileId> MapDatabase::ListMosaicTiles(int zoom) const {
  const std::lock_guard lock(impl_->mutex);
  return ReadMosaicTileIds(impl_->connection, zoom);
}

FloorMap MapDatabase::ReadVerifiedMap() const {
  FloorMap map = ReadMap();
  for (int zoom = 0; zoom <= map.mosaic.max_zoom; ++zoom) {
    for (const TileId& tile : ListMosaicTiles(zoom)) {
      ReadMosaicTile(tile);
    }
  }
  const std::lock_guard lock(impl_->mutex);
  for (const MapFileLayer& layer : map.info.layers) {
    if (layer.known && !layer.content_hash.empty() &&
        ComputeLayerHash(impl_->connection, layer.name) != layer.content_hash) {
      ThrowDamaged(impl_->connection, "its layer '" + layer.name + "' does not have the recorded content");
    }
  }
  if (ComputeContentVersion(impl_->connection) != map.info.content_version) {
    ThrowDamaged(impl_->connection, "its content does not have the recorded version");
  }
  return map;
}

void MapDatabase::VerifyContent() const { ReadVerifiedMap(); }

}  // namespace floorloc
