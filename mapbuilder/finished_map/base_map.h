// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/map/map_database.h"
#include "mapbuilder/coverage/coverage.h"

namespace floorloc {

/// A finished map that another one is built on: all of it but the mosaic, which stays in the file.
struct BaseMap {
  /// Throws MapError.
  explicit BaseMap(const std::filesystem::path& path);

  std::filesystem::path file;
  MapDatabase database;
  FloorMap map;
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
  CoverageGrid coverage;  ///< by its frames

  int survey_count() const { return static_cast<int>(map.info.cameras.size()); }
  /// Of each frame.
  std::vector<std::optional<Pose2>> Poses() const;
  std::vector<RectM> Floors() const;
  /// One sentence per layer that this program does not know: a map that is made from this one will not have it.
  std::vector<std::string> LayersLeftBehind() const;
};

/// Of a map's frames and of further ones.
CoverageGrid CoverageOfAll(const BaseMap& base_map, const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base);

}  // namespace floorloc
