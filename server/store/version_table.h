// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/store/state_file.h"

namespace floorloc {

/// A map file that the server keeps.
struct MapVersion {
  std::string version;  ///< content version
  std::string id;       ///< of the map: versions with the same id have the same frame
  std::string created;  ///< ISO 8601, UTC
  std::string builder_version;
  std::vector<std::string> parents;  ///< content versions
  double area_m2 = 0.0;
  std::int64_t bytes = 0;
  double added_s = 0.0;  ///< Unix time
  std::string origin;    ///< "upload", "folder" or "recovered"
};

/// All versions of one map.
struct MapVersions {
  std::string active;         ///< content version; empty: none
  std::string previous;       ///< active before; empty: none
  std::string file_identity;  ///< FileIdentity of the folder's file when it was last taken; empty: never
  std::string file_version;   ///< its content version
  std::vector<MapVersion> versions;

  const MapVersion* Find(const std::string& version) const;
};

// Functions of a StateFile's connection, by name of the map.
std::map<std::string, MapVersions> ReadVersions(const SqliteConnection& connection);
void WriteVersion(const SqliteConnection& connection, const std::string& map, const MapVersion& version);
void DeleteVersion(const SqliteConnection& connection, const std::string& map, const std::string& version);
/// All but the versions themselves.
void WriteActive(const SqliteConnection& connection, const std::string& map, const MapVersions& versions);
/// With all its versions.
void DeleteMap(const SqliteConnection& connection, const std::string& map);

}  // namespace floorloc
