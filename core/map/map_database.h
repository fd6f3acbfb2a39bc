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

/// A map file opened read-only. Thread-safe: calls are serialised inside.
class MapDatabase {
 public:
  /// Checks the application id, the format version and SQLite's quick_check. Throws MapError.
  explicit MapDatabase(const std::filesystem::path& file);
  ~MapDatabase();
  MapDatabase(const MapDatabase&) = delete;
  MapDatabase& operator=(const MapDatabase&) = delete;

  MapInfo ReadInfo() const;
  MosaicLayout ReadMosaicLayout() const;
  /// Info, layout and all keypoints, every blob's length and checksum verified. Throws MapError.
  FloorMap ReadMap() const;
  std::vector<MapFrame> ReadFrames() const;
  /// Every link joins two of ReadFrames(). Throws MapError.
  std::vector<MapLink> ReadLinks() const;
  /// The encoded JPEG of a mosaic tile; empty where the map has none. Throws MapError when damaged.
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  std::vector<TileId> ListMosaicTiles(int zoom) const;
  /// Recomputes the content version over everything. Throws MapError when it differs from the stored one.
  void VerifyContent() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
