// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/map_error.h"

namespace floorloc {

/// Writes a map to a temporary file beside the final one and renames it when complete: the old file is unchanged until
/// Commit(), and a writer that is destroyed before removes its file. Throws MapError (disk full, no permission, ...).
class MapWriter {
 public:
  explicit MapWriter(const std::filesystem::path& file);
  ~MapWriter();
  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;

  /// Frames are numbered by their order, links by these numbers.
  void WriteFrames(const std::vector<MapFrame>& frames);
  void WriteLinks(const std::vector<MapLink>& links);
  void WriteKeypoints(const MapKeypoints& keypoints, DescriptorType type);
  void WriteMosaicTiles(const std::vector<MosaicTile>& tiles);
  /// Writes MapKeypoints::upright of the keypoints that WriteKeypoints() wrote.
  void WriteUprightDescriptors(const MapKeypoints& keypoints);
  /// A tile that WriteMosaicTiles() wrote; empty: none. Not thread-safe.
  std::optional<std::vector<std::uint8_t>> ReadMosaicTile(const TileId& tile) const;
  /// Writes info (its content_version is computed here), flushes to the disk, renames. Returns the content version.
  std::string Commit(const MapInfo& info, const MosaicLayout& mosaic);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
