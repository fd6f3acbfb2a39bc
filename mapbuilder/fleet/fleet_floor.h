// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clients/cpp/client.h"
#include "mapbuilder/fleet/drivable_area.h"
#include "mapbuilder/simulation/floor_texture.h"

namespace floorloc {

/// The floor of a served map as its mosaic shows it, or the part of it about the map's middle. Its frame is that of
/// FloorTexture: the map's, with the origin at corner_m.
struct FleetFloor {
  FloorTexture texture;
  cv::Mat surveyed;  ///< CV_8UC1, 255 where the floor is known, of cell_m per pixel
  double cell_m = 0.0;
  Eigen::Vector2d corner_m = Eigen::Vector2d::Zero();  ///< lower left corner, map frame
  bool whole = true;                                   ///< false: a part of the map
};

/// Chooses the map to drive in: the one that is named, or the only one that is served. Its answer of GET
/// /v1/maps/{map}. Throws InputError with a sentence that says what there is, client::CallError.
nlohmann::json ChooseServedMap(client::Client& server, const std::string& name);

/// Fetches the mosaic of a map in its finest level, of at most max_area_m2. Throws InputError when there is none or a
/// tile cannot be read, client::CallError.
FleetFloor FetchFloor(client::Client& server, const nlohmann::json& map, double max_area_m2);

}  // namespace floorloc
