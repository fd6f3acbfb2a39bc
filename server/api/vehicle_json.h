// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/map/floor_map.h"
#include "server/serving/vehicle_registry.h"

namespace floorloc {

/// Body of PUT /v1/vehicles/{id}.
struct VehicleRequest {
  std::string map;
  GivenCamera camera;
  VehicleGate gate;
};

/// Unknown keys are errors, except in camera and floor. Throws JsonError that names the field.
VehicleRequest ParseVehicleRequest(const std::string& text);

Vehicle MakeVehicle(const std::string& id, VehicleRequest request);

/// Of the version that the vehicle is bound to; null when it is not served.
const MapInfo* MapInfoOf(const Vehicle& vehicle);

nlohmann::json FormatVehicle(const VehicleState& state, double stale_after_s);
/// FormatVehicle without registration and counts.
nlohmann::json FormatVehicleSummary(const VehicleState& state, double stale_after_s);
/// What changes with every message: status, pose, silence.
nlohmann::json FormatLivePose(const VehicleState& state, const VehicleView& view, double stale_after_s);

/// The status of a vehicle that was silent for longer: its pose is not to be relied on.
inline constexpr const char* kStaleStatus = "stale";
/// stale_after_s: see ServerLimits.
std::string StatusOf(const VehicleView& view, double stale_after_s);

}  // namespace floorloc
