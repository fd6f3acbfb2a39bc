// SPDX-License-Identifier: Apache-2.0
#include "server/store/version_store.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/map/map_contract.h"
#include "core/map/map_database.h"
#include "server/wire/unix_time.h"

namespace floorloc {
namespace {

constexpr auto kPower = StateFile::Durability::kPower;

}  // namespace

MapVersion DescribeVersion(const MapInfo& info) {
  MapVersion version{info.content_version, info.id, info.created, info.builder_version, {}, info.area_m2, 0, 0.0, ""};
  for (const MapParent& parent : info.parents) {
    if (IsSha256(parent.content_version)) {
      version.parents.push_back(parent.content_version);
    }
  }
  return version;
}

VersionStore::VersionStore(const std::filesystem::path& folder, StateFile* state, bool writable)
    : state_(state), writable_(writable && state != nullptr), files_(folder) {}

void VersionStore::Load() {
  if (state_ == nullptr) {
    return;
  }
  state_->Read([this](const SqliteConnection& connection) { maps_ = ReadVersions(connection); });
  if (!writable_) {
    return;
  }
  std::set<std::pair<std::string, std::string>> files;
  for (const auto& [map, version] : files_.CleanUp()) {
    files.emplace(map, version);
    if (Get(map).Find(version) == nullptr) {
      Recover(map, version);
    }
  }
  for (const std::string& map : Maps()) {
    for (const MapVersion& version : Get(map).versions) {
      if (!files.contains({map, version.version})) {
        spdlog::error("map '{}': the file of version {:.12} is gone", map, version.version);
        Delete(map, version.version);
      }
    }
  }
}

// A server was killed after it kept the file, and before it noted that; or its state was moved away.
void VersionStore::Recover(const std::string& map, const std::string& version) {
  const std::filesystem::path file = files_.PathOf(map, version);
  try {
    MapVersion found = DescribeVersion(MapDatabase(file).ReadInfo());
    if (found.version != version) {
      throw MapError("it holds another version");
    }
    found.bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
    found.origin = "recovered";
    Note(map, std::move(found));
  } catch (const MapError& error) {
    spdlog::warn("{} is no version that this server kept ({}); remove it", file.string(), error.what());
  }
}

std::vector<std::string> VersionStore::Maps() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [map, versions] : maps_) {
    names.push_back(map);
  }
  return names;
}

std::optional<MapVersions> VersionStore::Find(const std::string& map) const {
  const std::lock_guard lock(mutex_);
  const auto found = maps_.find(map);
  return found == maps_.end() ? std::nullopt : std::optional(found->second);
}

void VersionStore::Remember(const std::string& map, const MapVersions& versions) {
  const std::lock_guard lock(mutex_);
  maps_[map] = versions;
}

void VersionStore::SetActive(const std::string& map, const MapVersions& versions) {
  if (writable_) {
    state_->Write(kPower, [&](const SqliteConnection& connection) { WriteActive(connection, map, versions); });
  }
  Remember(map, versions);
}

MapVersion VersionStore::Keep(const std::string& map, IncomingFile& file, MapVersion version) {
  const MapVersions versions = Get(map);
  if (const MapVersion* known = versions.Find(version.version)) {
    return *known;
  }
  version.bytes = static_cast<std::int64_t>(file.bytes());
  file.MoveTo(files_.PathOf(map, version.version));
  return Note(map, std::move(version));
}

MapVersion VersionStore::Note(const std::string& map, MapVersion version) {
  version.added_s = UnixTimeNow();
  MapVersions versions = Get(map);
  state_->Write(kPower, [&](const SqliteConnection& connection) {
    WriteVersion(connection, map, version);
    WriteActive(connection, map, versions);
  });
  versions.versions.push_back(version);
  Remember(map, versions);
  return version;
}

// The file first: a row without one is dropped at the next start, a file without a row would be taken up again.
void VersionStore::Delete(const std::string& map, const std::string& version) {
  files_.Remove(map, version);
  MapVersions versions = Get(map);
  versions.previous = versions.previous == version ? "" : versions.previous;
  std::erase_if(versions.versions, [&](const MapVersion& v) { return v.version == version; });
  state_->Write(kPower, [&](const SqliteConnection& connection) {
    DeleteVersion(connection, map, version);
    WriteActive(connection, map, versions);
  });
  Remember(map, versions);
}

void VersionStore::DeleteMap(const std::string& map) {
  for (const MapVersion& version : Get(map).versions) {
    files_.Remove(map, version.version);
  }
  state_->Write(kPower, [&](const SqliteConnection& connection) { floorloc::DeleteMap(connection, map); });
  const std::lock_guard lock(mutex_);
  maps_.erase(map);
}

void VersionStore::Prune(const std::string& map, std::size_t max_versions) {
  const MapVersions versions = Get(map);
  std::size_t excess = versions.versions.size() - std::min(versions.versions.size(), max_versions);
  for (const MapVersion& version : versions.versions) {
    if (excess > 0 && version.origin == "folder" && version.version != versions.active &&
        version.version != versions.previous) {
      Delete(map, version.version);
      spdlog::info("map '{}': version {:.12} is deleted, the oldest beyond limits.max_versions", map, version.version);
      --excess;
    }
  }
}

}  // namespace floorloc
