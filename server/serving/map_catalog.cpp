// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_catalog.h"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace floorloc {
namespace {

void SetError(const std::exception& error, const std::string& code, LoadedMap* map) {
  map->localizer.reset();
  map->database.reset();
  map->error = StripFolder(error.what(), map->file);
  map->error_code = code;
  spdlog::error("map '{}' is not served: {}", map->name, error.what());
}

}  // namespace

std::string StripFolder(std::string text, const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder)) {
    text.erase(at, folder.size());
  }
  return text;
}

std::string CodeOf(const MapError& error) {
  switch (error.kind()) {
    case MapError::Kind::kDamaged:
      return "map_damaged";
    case MapError::Kind::kUnsupported:
      return "map_unsupported";
    case MapError::Kind::kOther:
      break;
  }
  return "map_unavailable";
}

const MapInfo* InfoOf(const std::shared_ptr<const LoadedMap>& map) {
  return map != nullptr && map->ready() ? &map->info() : nullptr;
}

std::optional<std::vector<std::uint8_t>> LoadedMap::ReadTile(const TileId& tile) const {
  auto jpeg = database->ReadMosaicTile(tile);
  if (!opened->IsUnchanged()) {
    throw MapError(file.string() +
                   " was written while it was served; put maps into the folder under another name, "
                   "and rename them then");
  }
  return jpeg;
}

std::shared_ptr<LoadedMap> LoadMap(const std::string& name, const std::filesystem::path& file,
                                   const LocalizerOptions& options) {
  auto map = std::make_shared<LoadedMap>();
  map->name = name;
  map->file = file;
  try {
    map->opened = std::make_unique<const OpenedFile>(file);
    map->database = std::make_unique<const MapDatabase>(file);
    FloorMap content = map->database->ReadVerifiedMap();
    if (!map->opened->IsUnchanged() || !map->opened->IsStillAt(file)) {
      throw MapError(file.string() + " was written while it was read; it is read again when that ends");
    }
    map->localizer = std::make_unique<const Localizer>(
        std::move(content), options, [loaded = map.get()](const TileId& tile) { return loaded->ReadTile(tile); });
  } catch (const MapError& error) {
    SetError(error, CodeOf(error), map.get());
  } catch (const std::invalid_argument& error) {  // an extractor that this build lacks
    SetError(error, "map_unsupported", map.get());
  } catch (const std::exception& error) {
    SetError(error, "map_unavailable", map.get());
  }
  return map;
}

void MapCatalog::Set(std::shared_ptr<const LoadedMap> map) {
  const std::lock_guard lock(mutex_);
  maps_[map->name] = std::move(map);
}

void MapCatalog::Remove(const std::string& name) {
  const std::lock_guard lock(mutex_);
  maps_.erase(name);
}

std::shared_ptr<const LoadedMap> MapCatalog::Find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto it = maps_.find(name);
  return it == maps_.end() ? nullptr : it->second;
}

std::vector<std::shared_ptr<const LoadedMap>> MapCatalog::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<const LoadedMap>> maps;
  maps.reserve(maps_.size());
  for (const auto& [name, map] : maps_) {
    maps.push_back(map);
  }
  return maps;
}

std::size_t MapCatalog::CountReady() const {
  const auto maps = All();
  return static_cast<std::size_t>(std::count_if(maps.begin(), maps.end(), [](const auto& m) { return m->ready(); }));
}

}  // namespace floorloc
