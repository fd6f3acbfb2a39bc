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

namespace floorloc {

/// A loaded map; immutable. A request keeps the one that it started with.
struct LoadedMap {
  std::string name;
  std::filesystem::path file;
  std::string error;       ///< why it is not served; empty when it is
  std::string error_code;  ///< map_damaged, map_unsupported (needs another version) or map_unavailable
  std::unique_ptr<const MapDatabase> database;
  std::unique_ptr<const Localizer> localizer;

  bool ready() const { return localizer != nullptr; }
  const MapInfo& info() const { return localizer->map().info; }
};

/// Removes the folder from an error about a map's file: clients must not learn the server's paths.
std::string StripFolder(std::string text, const std::filesystem::path& file);

/// Error code of the API for an error about a map's file: map_damaged, map_unsupported or map_unavailable.
std::string CodeOf(const MapError& error);

/// Opens a map file and builds its search structures. Does not throw for a bad file: sets `error` and `error_code`.
std::shared_ptr<const LoadedMap> LoadMap(const std::filesystem::path& file, const LocalizerOptions& options);

/// All maps of a folder, by name. Thread-safe.
class MapCatalog {
 public:
  /// Loads every NAME.floormap of the folder; warns of and skips invalid names. Throws InputError when the folder
  /// cannot be read.
  MapCatalog(const std::filesystem::path& folder, const LocalizerOptions& options);

  /// Null when there is no such map.
  std::shared_ptr<const LoadedMap> Find(const std::string& name) const;
  std::vector<std::shared_ptr<const LoadedMap>> All() const;
  std::size_t CountReady() const;

 private:
  void Set(std::shared_ptr<const LoadedMap> map);

  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const LoadedMap>> maps_;
};

}  // namespace floorloc
