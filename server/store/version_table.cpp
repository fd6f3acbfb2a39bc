// SPDX-License-Identifier: Apache-2.0
#include "server/store/version_table.h"

#include <algorithm>
#include <sstream>

namespace floorloc {
namespace {

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

std::vector<std::string> Split(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

}  // namespace

const MapVersion* MapVersions::Find(const std::string& version) const {
  const auto found =
      std::find_if(versions.begin(), versions.end(), [&](const MapVersion& v) { return v.version == version; });
  return found == versions.end() ? nullptr : &*found;
}

std::map<std::string, MapVersions> ReadVersions(const SqliteConnection& connection) {
  std::map<std::string, MapVersions> maps;
  SqliteStatement map(connection, "SELECT name, active, previous, file_identity, file_version FROM map");
  while (map.Step()) {
    maps[map.Text(0)] = {map.Text(1), map.Text(2), map.Text(3), map.Text(4), {}};
  }
  SqliteStatement row(connection,
                      "SELECT map, version, id, created, builder_version, parents, area_m2, bytes, added_s, origin "
                      "FROM version ORDER BY added_s, version");
  while (row.Step()) {
    maps[row.Text(0)].versions.push_back({row.Text(1), row.Text(2), row.Text(3), row.Text(4), Split(row.Text(5)),
                                          row.Real(6), row.Integer(7), row.Real(8), row.Text(9)});
  }
  return maps;
}

void WriteVersion(const SqliteConnection& connection, const std::string& map, const MapVersion& version) {
  SqliteStatement(connection, "INSERT OR REPLACE INTO version VALUES (?,?,?,?,?,?,?,?,?,?)")
      .Bind(map)
      .Bind(version.version)
      .Bind(version.id)
      .Bind(version.created)
      .Bind(version.builder_version)
      .Bind(Join(version.parents))
      .Bind(version.area_m2)
      .Bind(version.bytes)
      .Bind(version.added_s)
      .Bind(version.origin)
      .Run();
}

void DeleteVersion(const SqliteConnection& connection, const std::string& map, const std::string& version) {
  SqliteStatement(connection, "DELETE FROM version WHERE map = ? AND version = ?").Bind(map).Bind(version).Run();
}

void WriteActive(const SqliteConnection& connection, const std::string& map, const MapVersions& versions) {
  SqliteStatement(connection, "INSERT OR REPLACE INTO map VALUES (?,?,?,?,?)")
      .Bind(map)
      .Bind(versions.active)
      .Bind(versions.previous)
      .Bind(versions.file_identity)
      .Bind(versions.file_version)
      .Run();
}

void DeleteMap(const SqliteConnection& connection, const std::string& map) {
  SqliteStatement(connection, "DELETE FROM version WHERE map = ?").Bind(map).Run();
  SqliteStatement(connection, "DELETE FROM map WHERE name = ?").Bind(map).Run();
}

}  // namespace floorloc
