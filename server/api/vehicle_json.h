// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/geometry/floor_plane.h"
#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// Body of PUT /v1/vehicles/{id}.
struct VehicleRequest {
  std::string map;
  FloorCamera camera;
  VehicleGate gate;
};

/// Strict, camera and floor excepted. Throws JsonError that names the field.
VehicleRequest ParseVehicleRequest(const std::string& text);

/// map_version: of the map that is served now, in which the vehicle's pose is.
nlohmann::json FormatVehicle(const VehicleState& state, const std::string& map_version);
/// Without the registration and the counts.
nlohmann::json FormatVehicleSummary(const VehicleState& state, const std::string& map_version);

}  // namespace floorloc
