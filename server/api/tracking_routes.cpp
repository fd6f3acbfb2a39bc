// SPDX-License-Identifier: Apache-2.0
#include "core/io/trajectory.h"
#include "server/api/picture_call.h"
#include "server/api/routes.h"
#include "server/api/tracking_json.h"
#include "server/serving/localize_service.h"

namespace floorloc {
namespace {

/// A frames call, taken apart.
struct FrameCall {
  FrameRequest request;
  std::span<const std::uint8_t> image;  ///< encoded; belongs to the HTTP request
};

std::span<const std::uint8_t> Bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

FrameCall ParseCall(const HttpRequest& request) {
  if (request.ContentType() != "multipart/form-data") {
    return {ParseFrameQuery(request), Bytes(request.body)};
  }
  if (!request.query.empty()) {
    throw Problem(400, "invalid_parameter", "With multipart/form-data the fields belong into the part 'request'.");
  }
  return {ParseFrameJson(RequirePart(request, "request").content), Bytes(RequirePart(request, "image").content)};
}

MapLabel LabelOf(const LoadedMap& map) { return {map.name, map.info().content_version}; }

void CountFix(AppState& state, const std::string& map, const FixOutcome& fix) {
  if (fix.accepted) {
    state.metrics.CountFix({map, fix.reanchored ? "reanchored" : "accepted"});
  } else {
    state.metrics.CountFix({map, ToString(fix.reason)});
  }
}

FrameTurn TakeTurn(VehicleSession& session, const FrameRequest& request) {
  std::optional<FrameTurn> turn = session.BeginFrame(request.stamp_ns, request.motion);
  if (!turn) {
    throw Overload("vehicle_busy", "Another picture of this vehicle is being localized; send one at a time.");
  }
  return *std::move(turn);
}

HttpResponse AnswerFrame(AppState& state, const HttpRequest& request) {
  const FrameCall call = ParseCall(request);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(state, vehicle.vehicle->map);
  const FloorCamera& camera = vehicle.vehicle->camera();
  CheckImageHeader(call.image, camera.camera, state.config.limits.max_image_pixels);
  const FrameTurn turn = TakeTurn(*vehicle.session, call.request);
  FrameReport report;
  const LocalizeOutcome outcome = RunInPool(state.pool, [&] {
    const double resolution_m = map->info().camera().floor.resolution_m;
    const auto rectifier = camera.floor.resolution_m == resolution_m
                               ? vehicle.vehicle->rectifier
                               : state.rectifiers.Get(camera.AtResolution(resolution_m));
    LocalizeOutcome localized = RunLocalization({map, rectifier, call.image, turn.prior});
    report = vehicle.session->FinishFrame(turn, localized.features, localized.result);
    return localized;
  });
  state.metrics.CountMessage({map->name, ToString(report.message)});
  if (report.fix) {
    CountFix(state, map->name, *report.fix);
  }
  const PictureLabel label = {vehicle.vehicle->id, UnixTimeNow(), ToSeconds(turn.stamp_ns)};
  return JsonResponse(200, FormatFrameAnswer(report, RecordFix(state, *map, label, outcome), outcome));
}

HttpResponse AnswerOdometry(AppState& state, const HttpRequest& request) {
  const std::vector<OdometryMessage> increments = ParseOdometryJson(request.body);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(state, vehicle.vehicle->map);
  const OdometryReport report = vehicle.session->AddOdometry(increments);
  for (const MessageOutcome message : report.messages) {
    state.metrics.CountMessage({map->name, ToString(message)});
  }
  return JsonResponse(200, FormatOdometryAnswer(report, LabelOf(*map)));
}

HttpResponse AnswerInitialPose(AppState& state, const HttpRequest& request) {
  const InitialPoseRequest initial = ParseInitialPoseJson(request.body);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(state, vehicle.vehicle->map);
  return JsonResponse(200,
                      FormatInitialPoseAnswer(vehicle.session->SetPose(initial.pose, initial.stamp_ns), LabelOf(*map)));
}

}  // namespace

void AddTrackingRoutes(AppState& state, Router& router) {
  router.Add({"POST",
              "/v1/vehicles/{id}/frames",
              RouteAccess::kChange,
              {"image/jpeg", "image/png", "multipart/form-data"},
              [&state](const HttpRequest& request) { return AnswerFrame(state, request); }});
  router.Add({"POST",
              "/v1/vehicles/{id}/odometry",
              RouteAccess::kChange,
              {"application/json"},
              [&state](const HttpRequest& request) { return AnswerOdometry(state, request); }});
  router.Add({"POST",
              "/v1/vehicles/{id}/initialpose",
              RouteAccess::kChange,
              {"application/json"},
              [&state](const HttpRequest& request) { return AnswerInitialPose(state, request); }});
}

}  // namespace floorloc
