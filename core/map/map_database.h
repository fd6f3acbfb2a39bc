// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/map_error.h"

namespace floorloc {

/// A map file opened read-only. Thread-safe: calls are serialised inside. All functions return consistent data or throw
/// a MapError that names table, row and column: every index is valid, every number finite and within its range.
class MapDatabase {
 public:
  /// Checks the application id, the format version, SQLite's quick_check, that there are only tables, and that all
  /// required layers are known. Throws MapError.
  explicit MapDatabase(const std::filesystem::path& file);
  ~MapDatabase();
  MapDatabase(const MapDatabase&) = delete;
  MapDatabase& operator=(const MapDatabase&) = delete;

  MapInfo ReadInfo() const;
  MosaicLayout ReadMosaicLayout() const;
  /// Info, layout and all keypoints, every blob's length and checksum verified. Checks all other tables too.
  FloorMap ReadMap() const;
  /// The same after what VerifyContent() checks.
  FloorMap ReadVerifiedMap() const;
  std::vector<MapFrame> ReadFrames() const;
  /// Links index the frames of ReadFrames().
  std::vector<MapLink> ReadLinks() const;
  /// The encoded JPEG of a mosaic tile, its checksum verified; empty where the map has none.
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  /// Tiles of one level, all on the surveyed floor.
  std::vector<TileId> ListMosaicTiles(int zoom) const;
  /// Reads all known content and recomputes the content version by the rule of the file's format version. Throws
  /// MapError when it differs from the stored one. Unknown layers are not verified.
  void VerifyContent() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
