// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/vision/feature_extractor.h"
#include "core/vision/features.h"

namespace floorloc {

/// What a map says about itself; written once, when the map is built.
struct MapInfo {
  int format_version = 0;
  std::string builder_version;
  std::string id;               ///< UUID of the map; stays the same over its versions
  std::string content_version;  ///< SHA-256 of the content, hex
  std::string name;
  std::string created;        ///< ISO 8601, UTC
  double resolution_m = 0.0;  ///< of the mosaic's finest level
  RectM extent;               ///< of the surveyed floor, map frame
  double area_m2 = 0.0;       ///< surveyed floor
  ExtractorOptions extractor;
  FloorCamera camera;        ///< of the (first) survey
  std::string surveys_json;  ///< provenance: folders, frames
  std::string report_json;   ///< build report
};

/// One survey frame as it was placed.
struct MapFrame {
  std::int64_t stamp_ns = 0;
  std::string filename;
  Pose2 map_from_base;
};

/// All keypoints of a map, in memory, in the map frame.
struct MapKeypoints {
  std::vector<Keypoint> keypoints;
  std::vector<std::uint16_t> observations;  ///< number of frames that saw the point
  cv::Mat descriptors;

  std::size_t size() const { return keypoints.size(); }
};

/// Levels of the mosaic: level `max_zoom` has the map's resolution, every level above half of it.
/// Tile (z, x, y): x counts from the map frame's origin to the right (+x), y UP (+y); both may be negative.
struct MosaicLayout {
  int tile_px = 256;
  int max_zoom = 0;
  double resolution_m = 0.0;  ///< at max_zoom

  double TileSide(int zoom) const { return tile_px * resolution_m * static_cast<double>(1 << (max_zoom - zoom)); }
};

struct TileId {
  int z = 0;
  int x = 0;
  int y = 0;
  auto operator<=>(const TileId&) const = default;
};

struct MosaicTile {
  TileId id;
  std::vector<std::uint8_t> jpeg;  ///< encoded
};

/// A map in memory, without its mosaic.
struct FloorMap {
  MapInfo info;
  MosaicLayout mosaic;
  MapKeypoints keypoints;
};

}  // namespace floorloc
