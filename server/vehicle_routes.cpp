// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/names.h"
#include "server/routes.h"
#include "server/strict_json.h"
#include "server/vehicle_json.h"

namespace floorloc {
namespace {

Problem UnknownVehicle() {
  return {404, "unknown_vehicle", "No vehicle of this id is registered; register it with PUT /v1/vehicles/{id}."};
}

HttpResponse RegisterVehicle(AppState& state, const HttpRequest& request) {
  const std::string id = request.path_parameters.at("id");
  if (!IsVehicleId(id)) {
    throw Problem(400, "invalid_parameter", "A vehicle id has 1 to 64 letters, digits, '_', '.' and '-'.");
  }
  VehicleRequest parsed = ParseVehicleRequest(request.body);
  if (state.catalog.Find(parsed.map) == nullptr) {
    throw Problem(422, "unknown_map", "The vehicle names a map that is not served; GET /v1/maps lists them.");
  }
  Vehicle vehicle{id, parsed.map, parsed.gate,
                  RunInPool(state.pool, [&] { return state.rectifiers.Get(parsed.camera); })};
  const VehicleState answer{std::make_shared<const Vehicle>(vehicle), std::nullopt};
  const bool created = state.vehicles.Put(std::move(vehicle));
  return JsonResponse(created ? 201 : 200, ToText(FormatVehicle(answer)));
}

HttpResponse AnswerVehicle(const AppState& state, const HttpRequest& request) {
  const auto found = state.vehicles.Find(request.path_parameters.at("id"));
  if (!found) {
    throw UnknownVehicle();
  }
  return JsonResponse(200, ToText(FormatVehicle(*found)));
}

HttpResponse RemoveVehicle(AppState& state, const HttpRequest& request) {
  if (!state.vehicles.Remove(request.path_parameters.at("id"))) {
    throw UnknownVehicle();
  }
  return {204, "", "", {}};
}

}  // namespace

void AddVehicleRoutes(AppState& state, Router& router) {
  router.Add({"GET", "/v1/vehicles", RouteAccess::kRead, {}, [&state](const HttpRequest&) {
                return JsonResponse(200, FormatVehicleList(state.vehicles.All()));
              }});
  router.Add(
      {"PUT", "/v1/vehicles/{id}", RouteAccess::kChange, {"application/json"}, [&state](const HttpRequest& request) {
         return RegisterVehicle(state, request);
       }});
  router.Add({"GET", "/v1/vehicles/{id}", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return AnswerVehicle(state, request);
              }});
  router.Add({"DELETE", "/v1/vehicles/{id}", RouteAccess::kChange, {}, [&state](const HttpRequest& request) {
                return RemoveVehicle(state, request);
              }});
}

}  // namespace floorloc
