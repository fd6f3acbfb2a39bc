// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

BaseMap::BaseMap(const std::filesystem::path& path)
    : file(path),
      database(path),
      map(database.ReadMap()),
      frames(database.ReadFrames()),
      links(database.ReadLinks()),
      coverage(Poses(), Floors()) {
  if (frames.empty()) {
    throw MapError(file.string() + " has no frames; restore it from a copy or build it again",
                   MapError::Kind::kDamaged);
  }
}

std::vector<std::optional<Pose2>> BaseMap::Poses() const {
  std::vector<std::optional<Pose2>> poses;
  for (const MapFrame& frame : frames) {
    poses.emplace_back(frame.map_from_base);
  }
  return poses;
}

std::vector<RectM> BaseMap::Floors() const {
  std::vector<RectM> floors;
  for (const MapFrame& frame : frames) {
    floors.push_back(map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi);
  }
  return floors;
}

std::vector<std::string> BaseMap::LayersLeftBehind() const {
  std::vector<std::string> sentences;
  for (const MapFileLayer& layer : map.info.layers) {
    if (!layer.known) {
      sentences.push_back("the layer '" + layer.name + "' of " + file.filename().string() +
                          " is not in the new map: this version of floorloc does not know it; make it again, or use "
                          "the version that wrote it");
    }
  }
  return sentences;
}

CoverageGrid CoverageOfAll(const BaseMap& base_map, const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base) {
  std::vector<std::optional<Pose2>> poses = base_map.Poses();
  std::vector<RectM> floors = base_map.Floors();
  poses.insert(poses.end(), map_from_base.begin(), map_from_base.end());
  floors.insert(floors.end(), floor_in_base.begin(), floor_in_base.end());
  return {poses, floors};
}

}  // namespace floorloc
