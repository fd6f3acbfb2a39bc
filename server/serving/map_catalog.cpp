// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_catalog.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/io/input_error.h"
#include "server/wire/names.h"

namespace floorloc {
namespace {

std::vector<std::filesystem::path> ListMapFiles(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  if (error) {
    throw InputError(folder, "the maps folder cannot be read (" + error.message() + "); check --maps");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : entries) {
    if (entry.path().extension() == ".floormap" && entry.is_regular_file(error)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

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

std::shared_ptr<const LoadedMap> LoadMap(const std::filesystem::path& file, const LocalizerOptions& options) {
  auto map = std::make_shared<LoadedMap>();
  map->name = file.stem().string();
  map->file = file;
  try {
    map->database = std::make_unique<const MapDatabase>(file);
    map->localizer = std::make_unique<const Localizer>(
        map->database->ReadMap(), options,
        [&database = *map->database](const TileId& tile) { return database.ReadMosaicTile(tile); });
  } catch (const MapError& error) {
    SetError(error, CodeOf(error), map.get());
  } catch (const std::invalid_argument& error) {  // an extractor that this build lacks
    SetError(error, "map_unsupported", map.get());
  } catch (const std::exception& error) {
    SetError(error, "map_unavailable", map.get());
  }
  return map;
}

MapCatalog::MapCatalog(const std::filesystem::path& folder, const LocalizerOptions& options) {
  for (const std::filesystem::path& file : ListMapFiles(folder)) {
    if (!IsMapName(file.stem().string())) {
      spdlog::warn("{} is not served: name a map with letters, digits, _ and - (at most 64)", file.string());
      continue;
    }
    auto map = LoadMap(file, options);
    if (map->ready()) {
      spdlog::info("map '{}': version {:.12}, {:.1f} m2, {} keypoints", map->name, map->info().content_version,
                   map->info().area_m2, map->localizer->map().keypoints.size());
    }
    Set(std::move(map));
  }
}

void MapCatalog::Set(std::shared_ptr<const LoadedMap> map) {
  const std::lock_guard lock(mutex_);
  maps_[map->name] = std::move(map);
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
