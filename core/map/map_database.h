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

/// A map file opened read-only. Thread-safe: calls are serialised inside. What its functions return is consistent,
/// whatever the file holds: every index names something that is there, every number is finite and within reason. They
/// throw a MapError that names table, row and column where that does not hold.
class MapDatabase {
 public:
  /// Checks the application id, the format version, SQLite's quick_check, that there are tables only, and that no
  /// layer is required that this program does not know.
  explicit MapDatabase(const std::filesystem::path& file);
  ~MapDatabase();
  MapDatabase(const MapDatabase&) = delete;
  MapDatabase& operator=(const MapDatabase&) = delete;

  MapInfo ReadInfo() const;
  MosaicLayout ReadMosaicLayout() const;
  /// Info, layout and all keypoints, every blob's length and checksum verified. Checks all other tables, too.
  FloorMap ReadMap() const;
  std::vector<MapFrame> ReadFrames() const;
  /// Every link joins two of ReadFrames().
  std::vector<MapLink> ReadLinks() const;
  /// The encoded JPEG of a mosaic tile, its checksum verified; empty where the map has none.
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  /// Of one level; all lie on the surveyed floor.
  std::vector<TileId> ListMosaicTiles(int zoom) const;
  /// Reads every byte that this program knows and recomputes the content version, by the rule of the file's format
  /// version. Throws MapError when it differs from the stored one. Layers that it does not know are not looked into.
  void VerifyContent() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
