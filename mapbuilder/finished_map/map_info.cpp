// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_info.h"

#include <ctime>
#include <nlohmann/json.hpp>

#include "core/io/camera_yaml.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

std::string NewUuid() {
  std::string uuid = ReadTextFile("/proc/sys/kernel/random/uuid");
  std::erase(uuid, '\n');
  return uuid;
}

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

nlohmann::ordered_json ProvenanceOf(const Survey& survey) {
  nlohmann::ordered_json provenance = {
      {"folder", FolderName(survey.folder)},  {"camera", survey.camera.camera.name},
      {"frames", survey.frames.size()},       {"first_stamp", FormatSeconds(survey.frames.front().stamp_ns)},
      {"odometry", !survey.odometry.empty()}, {"control_points", survey.control_points.size()}};
  if (const std::string origin = ReadFloorOrigin(survey.folder); !origin.empty()) {
    provenance["mounting"] = origin;
  }
  return provenance;
}

// One object per survey, whatever surveys_json contains.
void AppendProvenance(const MapInfo& info, nlohmann::ordered_json* provenance) {
  const auto surveys = nlohmann::ordered_json::parse(info.surveys_json, nullptr, false);
  for (std::size_t i = 0; i < info.cameras.size(); ++i) {
    provenance->push_back(surveys.is_array() && i < surveys.size() ? surveys[i] : nlohmann::ordered_json::object());
  }
}

// Cameras as the surveys had them; those of a file that does not tell are taken as its cameras.
void AppendGivenCameras(const MapInfo& info, std::vector<FloorCamera>* given) {
  const std::vector<FloorCamera>& cameras = info.given_cameras.empty() ? info.cameras : info.given_cameras;
  given->insert(given->end(), cameras.begin(), cameras.end());
}

void AppendMasks(const MapInfo& info, std::vector<MapCameraMask>* masks) {
  std::vector<MapCameraMask> before = info.masks;
  before.resize(info.cameras.size());
  masks->insert(masks->end(), before.begin(), before.end());
}

void AppendFloorTextures(const MapInfo& info, std::vector<MapFloorTexture>* textures) {
  std::vector<MapFloorTexture> before = info.floor_textures;
  before.resize(info.cameras.size());
  textures->insert(textures->end(), before.begin(), before.end());
}

MapInfo NewInfo(const std::string& name, const std::string& id) {
  MapInfo info;
  info.builder_version = FLOORLOC_VERSION;
  info.id = id;
  info.name = name;
  info.created = UtcNow();
  return info;
}

}  // namespace

MapInfo MakeMapInfo(const std::string& name, const std::vector<LoadedSurvey>& surveys, const BaseMap* base_map) {
  MapInfo info = NewInfo(name, base_map != nullptr ? base_map->map.info.id : NewUuid());
  nlohmann::ordered_json provenance = nlohmann::json::array();
  if (base_map != nullptr) {
    const MapInfo& before = base_map->map.info;
    info.cameras = before.cameras;
    AppendGivenCameras(before, &info.given_cameras);
    AppendMasks(before, &info.masks);
    AppendFloorTextures(before, &info.floor_textures);
    info.parents = {{"extends", before.id, before.content_version}};
    AppendProvenance(before, &provenance);
  }
  for (const LoadedSurvey& loaded : surveys) {
    info.cameras.push_back(loaded.survey.camera);
    info.given_cameras.push_back(loaded.given_camera);
    provenance.push_back(ProvenanceOf(loaded.survey));
  }
  info.surveys_json = provenance.dump();
  return info;
}

MapInfo MakeMergedInfo(const std::string& name, const BaseMap& first, const BaseMap& second) {
  MapInfo info = NewInfo(name, first.map.info.id);
  info.extractor = first.map.info.extractor;
  nlohmann::ordered_json provenance = nlohmann::json::array();
  for (const BaseMap* map : {&first, &second}) {
    const MapInfo& before = map->map.info;
    info.cameras.insert(info.cameras.end(), before.cameras.begin(), before.cameras.end());
    AppendGivenCameras(before, &info.given_cameras);
    AppendMasks(before, &info.masks);
    AppendFloorTextures(before, &info.floor_textures);
    info.parents.push_back({"merges", before.id, before.content_version});
    AppendProvenance(before, &provenance);
  }
  info.surveys_json = provenance.dump();
  return info;
}

}  // namespace floorloc
