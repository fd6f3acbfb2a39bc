// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/map/map_database.h"
#include "mapbuilder/coverage/coverage.h"

namespace floorloc {

/// A finished map on which another one is based: all of it but the mosaic, which stays in the file.
struct BaseMap {
  /// Throws MapError.
  explicit BaseMap(const std::filesystem::path& path);

  std::filesystem::path file;
  MapDatabase database;
  FloorMap map;
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
  CoverageGrid coverage;  ///< of its frames

  int survey_count() const { return static_cast<int>(map.info.cameras.size()); }
  /// One per frame.
  std::vector<std::optional<Pose2>> Poses() const;
  std::vector<RectM> Floors() const;
  /// One sentence per layer unknown to this program, which a map made from this one will not have.
  std::vector<std::string> LayersLeftBehind() const;
};

/// Coverage by the map's frames and further ones.
CoverageGrid CoverageOfAll(const BaseMap& base_map, const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base);

}  // namespace floorloc
