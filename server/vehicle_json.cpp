// SPDX-License-Identifier: Apache-2.0
#include "server/vehicle_json.h"

#include <nlohmann/json.hpp>
#include <numbers>

#include "server/camera_json.h"
#include "server/localize_json.h"
#include "server/strict_json.h"

namespace floorloc {
namespace {

VehicleGate ParseGate(JsonObject object) {
  VehicleGate gate;
  if (object.Has("max_distance_m")) {
    gate.max_distance_m = object.Number("max_distance_m");
  }
  if (object.Has("max_angle_rad")) {
    gate.max_angle_rad = object.Number("max_angle_rad");
  }
  object.RejectUnknownKeys();
  if (gate.max_distance_m <= 0.0 || gate.max_angle_rad <= 0.0 || gate.max_angle_rad > std::numbers::pi) {
    throw JsonError("gate.max_distance_m must be positive, and gate.max_angle_rad between 0 and pi.");
  }
  return gate;
}

}  // namespace

VehicleRequest ParseVehicleRequest(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  VehicleRequest request;
  request.map = object.Text("map");
  request.camera = {ParseCamera(object.Value("camera")), ParseFloor(object.Value("floor"))};
  if (object.Has("gate")) {
    request.gate = ParseGate(object.Object("gate"));
  }
  object.RejectUnknownKeys();
  return request;
}

nlohmann::json FormatVehicle(const VehicleState& state) {
  const Vehicle& vehicle = *state.vehicle;
  return {{"id", vehicle.id},
          {"map", vehicle.map},
          {"camera", FormatCamera(vehicle.camera().camera)},
          {"floor", FormatFloor(vehicle.camera().floor)},
          {"gate", {{"max_distance_m", vehicle.gate.max_distance_m}, {"max_angle_rad", vehicle.gate.max_angle_rad}}},
          {"last_fix", state.last_fix ? FormatFixRecord(*state.last_fix) : nlohmann::json()}};
}

std::string FormatVehicleList(const std::vector<VehicleState>& states) {
  nlohmann::json vehicles = nlohmann::json::array();
  for (const VehicleState& state : states) {
    vehicles.push_back({{"id", state.vehicle->id},
                        {"map", state.vehicle->map},
                        {"last_fix", state.last_fix ? FormatFixRecord(*state.last_fix) : nlohmann::json()}});
  }
  return ToText({{"vehicles", std::move(vehicles)}});
}

}  // namespace floorloc
