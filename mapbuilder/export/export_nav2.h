// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/map/map_database.h"

namespace floorloc {

/// Occupancy grid in the format of ROS map servers (nav2_map_server, map_server).
struct OccupancyGrid {
  static constexpr std::uint8_t kFree = 254;
  static constexpr std::uint8_t kUnknown = 205;

  cv::Mat cells;  ///< CV_8UC1, row 0 at y_max: kFree where at least half of the cell was surveyed, else kUnknown
  double resolution_m = 0.0;
  Eigen::Vector2d lower_left_m = Eigen::Vector2d::Zero();  ///< outer corner of the lower left cell, map frame
};

/// Throws MapError when the grid would have more than 30,000 cells a side.
OccupancyGrid MakeOccupancyGrid(const MapDatabase& map, double resolution_m);

/// Writes `yaml` and, beside it, the image with the extension .pgm. Throws InputError.
void WriteNav2Map(const OccupancyGrid& grid, const std::filesystem::path& yaml);

}  // namespace floorloc
