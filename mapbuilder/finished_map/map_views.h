// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unordered_map>
#include <vector>

#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

/// What the frames of a map would see of its keypoints: the images are not in the map, but this takes their place.
/// Refers to the map.
class MapViews {
 public:
  explicit MapViews(const BaseMap& map);

  /// The map's keypoints inside the floor that a frame sees, in its base frame.
  Features Of(const MapFrame& frame) const;

 private:
  const BaseMap& map_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  // of the keypoints
};

}  // namespace floorloc
