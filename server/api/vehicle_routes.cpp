// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/api/image_call.h"
#include "server/api/routes.h"
#include "server/api/vehicle_json.h"
#include "server/wire/names.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

// Content version of the served map; empty when the map is not served, for then no pose refers to it.
std::string MapVersion(const AppState& state, const std::string& name) {
  const auto map = state.catalog.Find(name);
  return map != nullptr && map->ready() ? map->info().content_version : "";
}

HttpResponse RegisterVehicle(AppState& state, const HttpRequest& request) {
  const std::string id = request.path_parameters.at("id");
  if (!IsVehicleId(id)) {
    throw Problem(400, "invalid_parameter", "A vehicle id has 1 to 64 letters, digits, '_', '.' and '-'.");
  }
  VehicleRequest parsed = ParseVehicleRequest(request.body);
  const auto map = state.catalog.Find(parsed.map);
  if (map == nullptr) {
    throw Problem(422, "unknown_map", "The vehicle names a map that is not served; GET /v1/maps lists them.");
  }
  CheckMaskHeader(parsed.mask, parsed.camera.camera);
  Vehicle vehicle{id, parsed.map, parsed.gate,
                  RunInPool(state.pool, [&] { return state.rectifiers.Get(parsed.camera, parsed.mask); }),
                  parsed.mask.digest};
  const FloorCamera& camera = map->ready() ? map->info().camera() : parsed.camera;
  vehicle.map_resolution_m = camera.floor.resolution_m;
  const Registration registration = state.vehicles.Put(std::move(vehicle));
  return JsonResponse(registration.created ? 201 : 200,
                      ToText(FormatVehicle(registration.state, MapVersion(state, parsed.map))));
}

HttpResponse HandleVehicle(const AppState& state, const HttpRequest& request) {
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  return JsonResponse(200, ToText(FormatVehicle(vehicle, MapVersion(state, vehicle.vehicle->map))));
}

HttpResponse HandleVehicles(const AppState& state) {
  nlohmann::json vehicles = nlohmann::json::array();
  for (const VehicleState& vehicle : state.vehicles.All()) {
    vehicles.push_back(FormatVehicleSummary(vehicle, MapVersion(state, vehicle.vehicle->map)));
  }
  return JsonResponse(200, ToText({{"vehicles", std::move(vehicles)}}));
}

HttpResponse RemoveVehicle(AppState& state, const HttpRequest& request) {
  const std::string& id = request.path_parameters.at("id");
  if (!state.vehicles.Remove(id)) {
    throw UnknownVehicle();
  }
  return {204, "", "", {}};
}

}  // namespace

void AddVehicleRoutes(AppState& state, Router& router) {
  router.Add(
      {"GET", "/v1/vehicles", RouteAccess::kRead, {}, [&state](const HttpRequest&) { return HandleVehicles(state); }});
  router.Add(
      {"PUT", "/v1/vehicles/{id}", RouteAccess::kWrite, {"application/json"}, [&state](const HttpRequest& request) {
         return RegisterVehicle(state, request);
       }});
  router.Add({"GET", "/v1/vehicles/{id}", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleVehicle(state, request);
              }});
  router.Add({"DELETE", "/v1/vehicles/{id}", RouteAccess::kWrite, {}, [&state](const HttpRequest& request) {
                return RemoveVehicle(state, request);
              }});
}

}  // namespace floorloc
