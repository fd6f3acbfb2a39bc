// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_library.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/geometry/option_check.h"
#include "server/serving/map_folder.h"
#include "server/wire/names.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

// In the words of who gave the file: the server's own name of it says nothing to them.
std::string Rename(std::string error, const std::filesystem::path& file, const std::string& name) {
  const std::string own = file.filename().string();
  for (std::size_t at = error.find(own); at != std::string::npos; at = error.find(own, at + name.size())) {
    error.replace(at, own.size(), name);
  }
  return error;
}

Problem UnknownMap() { return {404, "unknown_map", "There is no map of this name; GET /v1/maps lists them."}; }

void RequireVersion(const MapVersions& versions, const std::string& version) {
  if (versions.Find(version) == nullptr) {
    throw Problem(404, "unknown_version", "The map has no such version; GET /v1/maps/{map}/versions lists them.");
  }
}

std::shared_ptr<const LoadedMap> NothingActive(const std::string& map) {
  auto nothing = std::make_shared<LoadedMap>();
  nothing->name = map;
  nothing->error = "no version of the map is active; activate one, GET /v1/maps/" + map + "/versions lists them";
  nothing->error_code = "map_unavailable";
  return nothing;
}

}  // namespace

void MapLibraryOptions::Check() const {
  localizer.Check();
  RequireOption(max_versions >= 2, "max_versions must be at least 2: the active one and the one before");
  RequireOption(max_map_bytes >= 1, "max_map_bytes must be at least 1");
  RequireOption(max_uploads >= 1, "max_uploads must be at least 1");
}

MapLibrary::MapLibrary(const std::filesystem::path& folder, const MapLibraryOptions& options, MapCatalog& catalog,
                       VersionStore& store)
    : folder_(folder),
      options_((options.Check(), options)),
      catalog_(catalog),
      store_(store),
      gate_(options.max_map_bytes, options.max_uploads) {}

void MapLibrary::RequireWritable() const {
  if (!store_.writable()) {
    throw Problem(409, "read_only",
                  "This server keeps no versions of maps: it was told so (read_only), another server uses its maps "
                  "folder, or the folder can't be written. Put maps into the folder instead.");
  }
}

bool MapLibrary::IsServed(const std::string& map) const {
  const auto served = catalog_.Find(map);
  return served != nullptr && served->ready();
}

std::optional<RefusedFile> MapLibrary::Refused(const std::string& map) const {
  const std::lock_guard lock(mutex_);
  const auto found = refused_.find(map);
  return found == refused_.end() ? std::nullopt : std::optional(found->second);
}

void MapLibrary::ForgetRefused(const std::string& map) {
  const std::lock_guard lock(mutex_);
  refused_.erase(map);
}

void MapLibrary::LoadAll() {
  const std::vector<std::filesystem::path> files = ListMapFiles(folder_);
  store_.Load();
  for (const std::filesystem::path& file : files) {
    if (IsMapName(file.stem().string())) {
      Take(file);
    } else {
      spdlog::warn("{} is not served: name a map with letters, digits, _ and - (at most 64)", file.string());
    }
  }
  for (const std::string& map : store_.Maps()) {
    if (!IsServed(map) && !store_.Get(map).versions.empty()) {
      LoadActive(map);
    }
  }
}

void MapLibrary::LoadActive(const std::string& map) {
  MapVersions versions = store_.Get(map);
  std::shared_ptr<const LoadedMap> loaded = NothingActive(map);
  if (versions.Find(versions.active) != nullptr) {
    loaded = LoadMap(map, store_.files().PathOf(map, versions.active), options_.localizer);
  }
  if (loaded->ready()) {
    Serve(loaded, versions.previous);
    return;
  }
  if (store_.writable() && versions.active == versions.file_version && PeekMapVersion(FileOf(map)) == versions.active) {
    store_.Delete(map, versions.active);  // the copy is damaged; what it was made of may be whole
    versions = store_.Get(map);
    versions.file_identity.clear();
    store_.Remember(map, versions);
    Take(FileOf(map));
  }
  if (!IsServed(map)) {
    catalog_.Set(loaded);
  }
}

void MapLibrary::TakeFolder() {
  const std::lock_guard lock(change_mutex_);
  for (const std::filesystem::path& file : ListMapFiles(folder_)) {
    if (IsMapName(file.stem().string())) {
      Take(file);
    }
  }
}

void MapLibrary::Take(const std::filesystem::path& file) {
  const std::string map = file.stem().string();
  const auto found = FileIdentity::Of(file);
  const std::string identity = found ? found->ToText() : "";
  const auto refused = Refused(map);
  if (!found || store_.Get(map).file_identity == identity || (refused && refused->identity == identity)) {
    return;
  }
  if (!store_.writable()) {
    TakeDirectly(file, identity);
    return;
  }
  try {
    TakeCopy(file, identity);
  } catch (const Problem& problem) {
    spdlog::warn("{} is served where it is, since no copy could be kept: {}", file.string(), problem.what());
    TakeDirectly(file, identity);
  }
}

void MapLibrary::TakeCopy(const std::filesystem::path& file, const std::string& identity) {
  const std::string map = file.stem().string();
  MapVersions versions = store_.Get(map);
  const bool starting = catalog_.Find(map) == nullptr;
  if (starting && versions.Find(versions.file_version) != nullptr && PeekMapVersion(file) == versions.file_version) {
    versions.file_identity = identity;  // the file that was taken before: what was activated since then stays active
    store_.SetActive(map, versions);
    return;
  }
  IncomingFile copy(store_.files().FolderOf(map), options_.max_map_bytes);
  copy.CopyFrom(file);
  auto loaded = LoadMap(map, copy.path(), options_.localizer);
  if (!loaded->ready()) {
    Refuse(std::move(loaded), file, identity);
    return;
  }
  MapVersion version = DescribeVersion(loaded->info());
  version.origin = "folder";
  store_.Keep(map, copy, version);
  loaded->file = copy.path();
  versions = store_.Get(map);
  versions.file_identity = identity;
  versions.file_version = version.version;
  ForgetRefused(map);
  ActivateLoaded(loaded, std::move(versions));
  store_.Prune(map, options_.max_versions);
}

// Without copies nothing is active but what the folder has.
void MapLibrary::TakeDirectly(const std::filesystem::path& file, const std::string& identity) {
  auto loaded = LoadMap(file.stem().string(), file, options_.localizer);
  if (!loaded->ready()) {
    Refuse(std::move(loaded), file, identity);
    return;
  }
  MapVersions versions = store_.Get(loaded->name);
  versions.file_identity = identity;
  store_.Remember(loaded->name, versions);
  ForgetRefused(loaded->name);
  Serve(loaded, "");
}

// What is served stays; without it, the map is listed with the reason.
void MapLibrary::Refuse(std::shared_ptr<LoadedMap> map, const std::filesystem::path& file,
                        const std::string& identity) {
  map->error = Rename(map->error, map->file, file.filename().string());
  map->file = file;
  {
    const std::lock_guard lock(mutex_);
    refused_[map->name] = {identity, map->error_code, map->error};
  }
  changes_.Add({0, map->name, "refused", "", "", 0, 0});
  if (!IsServed(map->name)) {
    catalog_.Set(std::move(map));
  }
}

BodyStream MapLibrary::Receive(const std::string& map, std::uint64_t announced_bytes) {
  if (!IsMapName(map)) {
    throw Problem(400, "invalid_parameter", "A map's name has 1 to 64 letters, digits, '_' and '-'.");
  }
  RequireWritable();
  return gate_.Open(store_.files().FolderOf(map), announced_bytes);
}

MapLibrary::Added MapLibrary::Add(const std::string& map, IncomingFile& file, bool activate) {
  auto loaded = LoadMap(map, file.path(), options_.localizer);
  if (!loaded->ready()) {
    throw Problem(loaded->error_code == "map_unavailable" ? 500 : 422, loaded->error_code,
                  Rename(loaded->error, file.path(), "The upload"));
  }
  const std::lock_guard lock(change_mutex_);
  const MapVersions versions = store_.Get(map);
  MapVersion version = DescribeVersion(loaded->info());
  version.origin = "upload";
  const bool known = versions.Find(version.version) != nullptr;
  if (!known && versions.versions.size() >= options_.max_versions) {
    throw Problem(409, "too_many_versions",
                  "The map has " + std::to_string(versions.versions.size()) +
                      " versions, the limit (limits.max_versions); delete one first.");
  }
  Added added{store_.Keep(map, file, version), !known};
  loaded->file = file.path();
  if (!known) {
    spdlog::info("map '{}': version {:.12} was uploaded and is whole", map, version.version);
    changes_.Add({0, map, "added", version.version, "", 0, 0});
  }
  if (activate || !IsServed(map)) {
    ActivateLoaded(loaded, store_.Get(map));
  }
  return added;
}

MapChange MapLibrary::Activate(const std::string& map, const std::string& version) {
  const MapVersions versions = store_.Get(map);
  if (versions.versions.empty() && catalog_.Find(map) == nullptr) {
    throw UnknownMap();
  }
  if (version == "previous" && versions.previous.empty()) {
    throw Problem(409, "no_previous_version", "No version was active before this one.");
  }
  const std::string wanted = version == "previous" ? versions.previous : version;
  RequireWritable();
  RequireVersion(versions, wanted);
  const auto loaded = LoadMap(map, store_.files().PathOf(map, wanted), options_.localizer);
  if (!loaded->ready()) {
    throw Problem(500, loaded->error_code, "The version is not activated: " + loaded->error);
  }
  const std::lock_guard lock(change_mutex_);
  RequireVersion(store_.Get(map), wanted);  // it may have been deleted meanwhile
  return ActivateLoaded(loaded, store_.Get(map));
}

// On the disk first, then for the requests that come.
MapChange MapLibrary::ActivateLoaded(const std::shared_ptr<const LoadedMap>& map, MapVersions versions) {
  const std::string& version = map->info().content_version;
  if (versions.active != version) {
    versions.previous = std::exchange(versions.active, version);
  }
  store_.SetActive(map->name, versions);
  return Serve(map, versions.previous);
}

MapChange MapLibrary::Serve(const std::shared_ptr<const LoadedMap>& map, const std::string& previous) {
  const MapInfo& info = map->info();
  MapChange change{0, map->name, "activated", info.content_version, previous, 0, 0};
  catalog_.Set(map);
  if (on_served_) {
    const MoveCounts moved = on_served_(map);
    change.kept = moved.kept;
    change.lost = moved.lost;
  }
  spdlog::info("map '{}': version {:.12}, {:.1f} m2, {} keypoints; {} vehicles keep their pose, {} lose it", map->name,
               info.content_version, info.area_m2, map->localizer->map().keypoints.size(), change.kept, change.lost);
  changes_.Add(change);
  return change;
}

void MapLibrary::Delete(const std::string& map, const std::string& version) {
  const std::lock_guard lock(change_mutex_);
  const MapVersions versions = store_.Get(map);
  if (versions.versions.empty() && catalog_.Find(map) == nullptr) {
    throw UnknownMap();
  }
  RequireWritable();
  RequireVersion(versions, version);
  if (version == versions.active) {
    throw Problem(409, "version_active", "The version is being served; activate another one first.");
  }
  store_.Delete(map, version);
  changes_.Add({0, map, "deleted", version, "", 0, 0});
}

void MapLibrary::DeleteMap(const std::string& map) {
  const std::lock_guard lock(change_mutex_);
  if (!store_.Find(map) && catalog_.Find(map) == nullptr) {
    throw UnknownMap();
  }
  RequireWritable();
  if (FileIdentity::Of(FileOf(map))) {
    throw Problem(409, "map_in_folder",
                  "The maps folder has " + map + ".floormap, which would be served again; remove it first.");
  }
  store_.DeleteMap(map);
  catalog_.Remove(map);
  changes_.Add({0, map, "removed", "", "", 0, 0});
  ForgetRefused(map);
}

}  // namespace floorloc
