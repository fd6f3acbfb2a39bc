// SPDX-License-Identifier: Apache-2.0
#include "server/api/map_json.h"
#include "server/api/routes.h"
#include "server/wire/number_text.h"

namespace floorloc {
namespace {

bool ParseActivate(const HttpRequest& request) {
  const std::string text = request.QueryValue("activate").value_or("false");
  if (text != "true" && text != "false") {
    throw Problem(400, "invalid_parameter", "activate must be true or false.");
  }
  return text == "true";
}

std::uint64_t AnnouncedBytes(const HttpRequest& head) {
  const std::optional<double> bytes = ParseFinite(head.Header("content-length"));
  return bytes && *bytes > 0.0 ? static_cast<std::uint64_t>(*bytes) : 0;
}

HttpResponse HandleUpload(AppState& state, const HttpRequest& request) {
  const std::string& map = request.path_parameters.at("map");
  const bool activate = ParseActivate(request);
  auto* file = dynamic_cast<IncomingFile*>(request.sink.get());
  if (file == nullptr) {
    throw ProblemOfStatus(500);
  }
  const MapLibrary::Added added = state.library.Add(map, *file, activate);
  HttpResponse response =
      JsonResponse(added.created ? 201 : 200, FormatVersion(added.version, state.library.Versions(map)->active));
  response.headers["Location"] = "/v1/maps/" + map + "/versions/" + added.version.version;
  return response;
}

HttpResponse HandleVersions(const AppState& state, const HttpRequest& request) {
  const auto map = FindMap(state, request);
  return JsonResponse(200, FormatVersions(*map, state.library));
}

HttpResponse HandleActivate(AppState& state, const HttpRequest& request) {
  const auto& path = request.path_parameters;
  return JsonResponse(200, FormatActivation(state.library.Activate(path.at("map"), path.at("version"))));
}

HttpResponse HandleDeleteMap(AppState& state, const HttpRequest& request) {
  const std::string& map = request.path_parameters.at("map");
  const std::vector<VehicleState> vehicles = state.vehicles.All();
  if (std::any_of(vehicles.begin(), vehicles.end(), [&](const auto& v) { return v.vehicle->map == map; })) {
    throw Problem(409, "map_in_use", "Vehicles are registered on this map; register them on another, or delete them.");
  }
  state.library.DeleteMap(map);
  return {204, "", "", {}};
}

}  // namespace

void AddVersionRoutes(AppState& state, Router& router) {
  router.Add({"GET", "/v1/maps/{map}/versions", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleVersions(state, request);
              }});
  router.Add({"POST",
              "/v1/maps/{map}/versions",
              RouteAccess::kAdmin,
              {"application/octet-stream", "application/vnd.sqlite3"},
              [&state](const HttpRequest& request) { return HandleUpload(state, request); },
              [](const HttpRequest& head) { ParseActivate(head); },
              [&state](const HttpRequest& head) {
                return state.library.Receive(head.path_parameters.at("map"), AnnouncedBytes(head));
              }});
  router.Add({"POST",
              "/v1/maps/{map}/versions/{version}/activate",
              RouteAccess::kAdmin,
              {},
              [&state](const HttpRequest& request) { return HandleActivate(state, request); }});
  router.Add(
      {"DELETE", "/v1/maps/{map}/versions/{version}", RouteAccess::kAdmin, {}, [&state](const HttpRequest& request) {
         state.library.Delete(request.path_parameters.at("map"), request.path_parameters.at("version"));
         return HttpResponse{204, "", "", {}};
       }});
  router.Add({"DELETE", "/v1/maps/{map}", RouteAccess::kAdmin, {}, [&state](const HttpRequest& request) {
                return HandleDeleteMap(state, request);
              }});
}

}  // namespace floorloc
