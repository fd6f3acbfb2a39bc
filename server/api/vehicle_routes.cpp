// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/api/admission.h"
#include "server/api/diagnosis_json.h"
#include "server/api/image_call.h"
#include "server/api/routes.h"
#include "server/api/vehicle_json.h"
#include "server/wire/names.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

// Of the served map; null when it is not served, for then no pose refers to it.
const MapInfo* InfoOf(const std::shared_ptr<const LoadedMap>& map) {
  return map != nullptr && map->ready() ? &map->info() : nullptr;
}

nlohmann::json Describe(const AppState& state, const VehicleState& vehicle) {
  const auto map = state.catalog.Find(vehicle.vehicle->map);
  return FormatVehicle(vehicle, InfoOf(map), state.config.limits.stale_after_s);
}

// Prepares the camera for the map; for one that is not served, as it was given.
void PrepareCamera(const MapInfo* info, RectifierStore& store, Vehicle* vehicle) {
  store.Check(vehicle->camera.camera);
  vehicle->in_map = info != nullptr ? CameraInMap(*info, vehicle->camera, store)
                                    : MapCamera{store.Get(vehicle->camera.camera, vehicle->camera.mask), std::nullopt};
  vehicle->camera.mask = {vehicle->camera.mask.digest, "", vehicle->in_map.rectifier->raw_mask()};
  vehicle->map_version = info != nullptr ? info->content_version : "";
  vehicle->map_resolution_m = (info != nullptr ? info->camera() : vehicle->camera.camera).floor.resolution_m;
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
  CheckMaskHeader(parsed.camera.mask, parsed.camera.camera.camera);
  Vehicle vehicle{id, parsed.map, parsed.gate, std::move(parsed.camera), {}, ""};
  const JobLabel label = MakeLabel(request, "address/" + request.remote_address, WorkClass::kSearch);
  RunInPool(state, label, [&] { PrepareCamera(InfoOf(map), state.rectifiers, &vehicle); });
  const Registration registration = state.vehicles.Put(std::move(vehicle));
  return JsonResponse(registration.created ? 201 : 200,
                      ToText(FormatVehicle(registration.state, InfoOf(map), state.config.limits.stale_after_s)));
}

HttpResponse HandleVehicle(const AppState& state, const HttpRequest& request) {
  return JsonResponse(200, ToText(Describe(state, RequireVehicle(state, request.path_parameters.at("id")))));
}

HttpResponse HandleDiagnosis(const AppState& state, const HttpRequest& request) {
  return JsonResponse(200, FormatDiagnosis(RequireVehicle(state, request.path_parameters.at("id"))));
}

HttpResponse HandleVehicles(const AppState& state) {
  nlohmann::json vehicles = nlohmann::json::array();
  for (const VehicleState& vehicle : state.vehicles.All()) {
    const auto map = state.catalog.Find(vehicle.vehicle->map);
    vehicles.push_back(FormatVehicleSummary(vehicle, InfoOf(map), state.config.limits.stale_after_s));
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
      {"PUT", "/v1/vehicles/{id}", RouteAccess::kChange, {"application/json"}, [&state](const HttpRequest& request) {
         return RegisterVehicle(state, request);
       }});
  router.Add({"GET", "/v1/vehicles/{id}", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleVehicle(state, request);
              }});
  router.Add({"GET", "/v1/vehicles/{id}/diagnosis", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleDiagnosis(state, request);
              }});
  router.Add({"DELETE", "/v1/vehicles/{id}", RouteAccess::kChange, {}, [&state](const HttpRequest& request) {
                return RemoveVehicle(state, request);
              }});
}

}  // namespace floorloc
