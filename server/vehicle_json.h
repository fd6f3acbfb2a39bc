// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/geometry/floor_plane.h"
#include "server/vehicle_registry.h"

namespace floorloc {

/// Body of PUT /v1/vehicles/{id}.
struct VehicleRequest {
  std::string map;
  FloorCamera camera;
  VehicleGate gate;
};

/// Strict, camera and floor excepted. Throws JsonError that names the field.
VehicleRequest ParseVehicleRequest(const std::string& text);

nlohmann::json FormatVehicle(const VehicleState& state);
/// {"vehicles":[...]}
std::string FormatVehicleList(const std::vector<VehicleState>& states);

}  // namespace floorloc
