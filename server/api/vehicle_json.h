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
  CameraMask mask;  ///< of the robot's body in the camera's images; may be empty
  VehicleGate gate;
};

/// Unknown keys are errors, except in camera and floor. Throws JsonError that names the field.
VehicleRequest ParseVehicleRequest(const std::string& text);

/// map_version: content version of the map as served now; the vehicle's pose refers to it.
nlohmann::json FormatVehicle(const VehicleState& state, const std::string& map_version);
/// FormatVehicle without registration and counts.
nlohmann::json FormatVehicleSummary(const VehicleState& state, const std::string& map_version);

}  // namespace floorloc
