// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// A map file is missing, damaged or of an unknown version. what() is one sentence that names it and says what to do.
class MapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A map file opened read-only. The only reader of SQL. Thread-safe: calls are serialised inside.
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
  /// The encoded JPEG of a mosaic tile; empty where the map has none. Throws MapError when damaged.
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  std::vector<TileId> ListMosaicTiles(int zoom) const;
  /// Recomputes the content version over everything. Throws MapError when it differs from the stored one.
  void VerifyContent() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a map beside its final place and renames it when whole: until Commit() the old file stays as it is, and a
/// writer that is destroyed before removes what it wrote. Throws MapError (disk full, no permission, ...).
class MapWriter {
 public:
  explicit MapWriter(const std::filesystem::path& file);
  ~MapWriter();
  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;

  void WriteFrames(const std::vector<MapFrame>& frames);
  void WriteKeypoints(const MapKeypoints& keypoints, DescriptorType type);
  void WriteMosaicTile(const TileId& tile, const std::vector<std::uint8_t>& jpeg);
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  /// Writes info (its content_version is computed here), flushes to the disk, renames. Returns the content version.
  std::string Commit(const MapInfo& info, const MosaicLayout& mosaic);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
