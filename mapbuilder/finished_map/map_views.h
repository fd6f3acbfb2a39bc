// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unordered_map>
#include <vector>

#include "mapbuilder/finished_map/base_map.h"

namespace floorloc {

/// Map keypoints in the view of each frame, in place of the images, which are not in the map. Keeps a reference to the
/// map.
class MapViews {
 public:
  explicit MapViews(const BaseMap& map);

  /// Map keypoints inside the floor that a frame covers, in its base frame.
  Features Of(const MapFrame& frame) const;

 private:
  const BaseMap& map_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  // keypoint indices by cell
};

}  // namespace floorloc
