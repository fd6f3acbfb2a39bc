// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/api/admission.h"
#include "server/api/diagnosis_json.h"
#include "server/api/image_call.h"
#include "server/api/inspection_json.h"
#include "server/api/localize_json.h"
#include "server/api/ros_json.h"
#include "server/api/routes.h"
#include "server/api/vehicle_json.h"
#include "server/serving/vehicle_moves.h"
#include "server/wire/names.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

// Bound to the map that is served now: another version may have come while its camera was prepared.
Registration Register(AppState& state, Vehicle vehicle, const std::string& body) {
  const std::string map = vehicle.map;
  Registration registration =
      state.keeper != nullptr ? state.keeper->Put(std::move(vehicle), body) : state.vehicles.Put(std::move(vehicle));
  if (const auto served = state.catalog.Find(map); served != nullptr && served != registration.state.vehicle->served) {
    MoveVehicles(served, state.vehicles, state.rectifiers);
    registration.state = state.vehicles.Find(registration.state.vehicle->id).value_or(registration.state);
  }
  return registration;
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
  Vehicle vehicle = MakeVehicle(id, std::move(parsed));
  const JobLabel label = MakeLabel(request, "address/" + request.remote_address, WorkClass::kSearch);
  RunInPool(state, label, [&] { BindToMap(map, state.rectifiers, &vehicle); });
  const Registration registration = Register(state, std::move(vehicle), request.body);
  state.last_frames.Remove(registration.evicted);
  return JsonResponse(registration.created ? 201 : 200,
                      ToText(FormatVehicle(registration.state, state.config.limits.stale_after_s)));
}

HttpResponse HandleVehicle(const AppState& state, const HttpRequest& request) {
  const std::string format = request.QueryValue("format").value_or("json");
  if (format != "json" && format != "ros") {
    throw Problem(400, "invalid_parameter", "format is json or ros.");
  }
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const double stale_after_s = state.config.limits.stale_after_s;
  return JsonResponse(
      200, ToText(format == "ros" ? FormatRosVehicle(vehicle, stale_after_s) : FormatVehicle(vehicle, stale_after_s)));
}

HttpResponse HandleDiagnosis(const AppState& state, const HttpRequest& request) {
  return JsonResponse(200, FormatDiagnosis(RequireVehicle(state, request.path_parameters.at("id"))));
}

// The image is localized once more: nothing is prepared for people who may never look.
HttpResponse HandleLastFrame(AppState& state, const HttpRequest& request) {
  const std::string& id = request.path_parameters.at("id");
  RequireVehicle(state, id);
  const std::shared_ptr<const KeptFrame> frame = state.last_frames.Find(id);
  LocalizeJob job = frame == nullptr ? LocalizeJob() : frame->Job();
  if (job.map == nullptr) {
    throw Problem(
        404, "no_last_frame",
        "No image of this vehicle is kept: it has sent none since the server started or its map was replaced, "
        "or others needed the memory (limits.max_kept_frame_bytes).");
  }
  job.inspect = true;
  const JobLabel label = MakeLabel(request, "address/" + request.remote_address, WorkClass::kSearch);
  const LocalizeOutcome outcome = RunInPool(state, label, [&] { return RunLocalization(job); });
  return JsonResponse(200, ToText({{"map", job.map->name},
                                   {"map_version", job.map->info().content_version},
                                   {"fix", FormatFixRecord(frame->fix())},
                                   {"inspection", FormatInspection(*outcome.inspection)}}));
}

HttpResponse HandleVehicles(const AppState& state) {
  nlohmann::json vehicles = nlohmann::json::array();
  for (const VehicleState& vehicle : state.vehicles.All()) {
    vehicles.push_back(FormatVehicleSummary(vehicle, state.config.limits.stale_after_s));
  }
  return JsonResponse(200, ToText({{"vehicles", std::move(vehicles)}}));
}

HttpResponse RemoveVehicle(AppState& state, const HttpRequest& request) {
  const std::string& id = request.path_parameters.at("id");
  if (!(state.keeper != nullptr ? state.keeper->Remove(id) : state.vehicles.Remove(id))) {
    throw UnknownVehicle();
  }
  state.last_frames.Remove(id);
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
  router.Add({"GET", "/v1/vehicles/{id}/last_frame", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleLastFrame(state, request);
              }});
  router.Add({"DELETE", "/v1/vehicles/{id}", RouteAccess::kChange, {}, [&state](const HttpRequest& request) {
                return RemoveVehicle(state, request);
              }});
}

}  // namespace floorloc
