// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

/// The columns of one row of keypoint_tile, packed as in schema/map.sql.
struct KeypointBlobs {
  int count = 0;
  Blob position, angle, size, response, observations, distinctiveness, last_survey, descriptor;

  std::int64_t Checksum() const;
};

struct KeypointTile {
  int x = 0;
  int y = 0;
  double side_m = 1.0;

  /// Lower left corner, map frame.
  Eigen::Vector2d Corner() const { return {x * side_m, y * side_m}; }
};

/// Indices of the keypoints in each tile (x, y), ascending.
std::map<std::pair<int, int>, std::vector<int>> KeypointsByTile(const MapKeypoints& keypoints, double tile_m);

KeypointBlobs PackKeypoints(const MapKeypoints& keypoints, std::span<const int> indices, const KeypointTile& tile);

/// Appends a tile's keypoints, relative to keypoints->origin_m. row_bytes: bytes per descriptor. Returns false when a
/// blob has the wrong length, a keypoint lies outside the tile or a number is not finite.
bool UnpackKeypoints(const KeypointBlobs& blobs, const KeypointTile& tile, std::size_t row_bytes,
                     MapKeypoints* keypoints);

}  // namespace floorloc
