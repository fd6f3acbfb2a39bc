// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "server/store/file_identity.h"

namespace floorloc {

/// A loaded map; immutable. A request keeps the one that it started with.
struct LoadedMap {
  std::string name;
  std::filesystem::path file;
  std::string error;       ///< why it is not served; empty when it is
  std::string error_code;  ///< map_damaged, map_unsupported (needs another version) or map_unavailable
  std::unique_ptr<const OpenedFile> opened;
  std::unique_ptr<const MapDatabase> database;
  std::unique_ptr<const Localizer> localizer;

  bool ready() const { return localizer != nullptr; }
  const MapInfo& info() const { return localizer->map().info; }
  /// MapDatabase::ReadMosaicTile. Throws MapError too when somebody has written into the file since it was loaded:
  /// what it holds now is not of this version.
  std::optional<std::vector<std::uint8_t>> ReadTile(const TileId& tile) const;
};

/// Of a map that is served; null when it is not, or there is none: no pose refers to it then.
const MapInfo* InfoOf(const std::shared_ptr<const LoadedMap>& map);

/// Removes the folder from an error about a map's file: clients must not learn the server's paths.
std::string StripFolder(std::string text, const std::filesystem::path& file);

/// Error code of the API for an error about a map's file: map_damaged, map_unsupported or map_unavailable.
std::string CodeOf(const MapError& error);

/// Opens a map file, verifies all of it, and builds its search structures. Does not throw for a bad file: sets `error`
/// and `error_code`.
std::shared_ptr<LoadedMap> LoadMap(const std::string& name, const std::filesystem::path& file,
                                   const LocalizerOptions& options);

/// The maps as they are served now, by name. Thread-safe.
class MapCatalog {
 public:
  void Set(std::shared_ptr<const LoadedMap> map);
  void Remove(const std::string& name);

  /// Null when there is no such map.
  std::shared_ptr<const LoadedMap> Find(const std::string& name) const;
  std::vector<std::shared_ptr<const LoadedMap>> All() const;
  std::size_t CountReady() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const LoadedMap>> maps_;
};

}  // namespace floorloc
