// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/map/floor_map.h"
#include "server/store/state_file.h"
#include "server/store/version_files.h"
#include "server/store/version_table.h"

namespace floorloc {

/// What a map file says of itself.
MapVersion DescribeVersion(const MapInfo& info);

/// The versions of all maps that a server keeps: files and the rows of its state. Files are whole before a row names
/// them, and a change is on the disk before it is seen here. Thread-safe. Throws Problem as IncomingFile and StateFile
/// do.
class VersionStore {
 public:
  /// state: null: there is nothing, and changes stay in memory. Not writable: likewise, but what it holds is there.
  VersionStore(const std::filesystem::path& folder, StateFile* state, bool writable);

  /// Reads the state; where a server was killed between a file and its row, makes them agree.
  void Load();
  bool writable() const { return writable_; }
  const VersionFiles& files() const { return files_; }

  std::vector<std::string> Maps() const;
  /// Empty for an unknown map. The newest version is last.
  std::optional<MapVersions> Find(const std::string& map) const;
  MapVersions Get(const std::string& map) const { return Find(map).value_or(MapVersions()); }

  /// Sets everything but the versions themselves.
  void SetActive(const std::string& map, const MapVersions& versions);
  /// The same in memory only.
  void Remember(const std::string& map, const MapVersions& versions);
  /// Moves a file among the versions. Returns the version as it is known.
  MapVersion Keep(const std::string& map, IncomingFile& file, MapVersion version);
  void Delete(const std::string& map, const std::string& version);
  void DeleteMap(const std::string& map);
  /// Deletes the oldest versions that came by the folder, beyond so many versions: nobody else does, and a new one may
  /// come every night. Keeps the active one and the one before.
  void Prune(const std::string& map, std::size_t max_versions);

 private:
  void Recover(const std::string& map, const std::string& version);
  /// Adds the row of a file that is among the versions now.
  MapVersion Note(const std::string& map, MapVersion version);

  StateFile* const state_;
  const bool writable_;
  const VersionFiles files_;
  mutable std::mutex mutex_;
  std::map<std::string, MapVersions> maps_;  // guarded by mutex_
};

}  // namespace floorloc
