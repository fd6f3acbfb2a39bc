// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include <chrono>

#include "core/io/trajectory.h"
#include "server/api/admission.h"
#include "server/api/image_call.h"
#include "server/api/routes.h"
#include "server/api/tracking_json.h"
#include "server/serving/localize_service.h"
#include "server/wire/unix_time.h"

namespace floorloc {
namespace {

/// A parsed frames call.
struct FrameCall {
  FrameRequest request;
  std::span<const std::uint8_t> image;  ///< encoded; owned by the HTTP request
};

std::span<const std::uint8_t> Bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

FrameCall ParseCall(const HttpRequest& request) {
  if (request.ContentType() != "multipart/form-data") {
    return {ParseFrameQuery(request), Bytes(request.body)};
  }
  if (!request.query.empty()) {
    throw Problem(400, "invalid_parameter", "With multipart/form-data the fields belong in the part 'request'.");
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

// One line when the odometry is rejected, for another reason, or used again.
void LogOdometry(const std::string& vehicle, const FrameReport& report) {
  const std::optional<FusedPose>& fused = report.view.fused;
  if (report.odometry_changed && fused && fused->odometry && fused->odometry->health == OdometryHealth::kRejected) {
    const OdometryFault fault = fused->odometry->fault;
    spdlog::warn("vehicle '{}': its odometry is rejected, {}. {}", vehicle, ToString(fault), CureOf(fault));
  } else if (report.odometry_changed) {
    spdlog::info("vehicle '{}': its odometry is not rejected any longer", vehicle);
  }
}

std::string ClientOf(const std::string& vehicle) { return "vehicle/" + vehicle; }

// An image that still waits for a thread gives way to the newer one.
FrameSlot AcquireSlot(AppState& state, const VehicleState& vehicle, const FrameRequest& request) {
  VehicleSession& session = *vehicle.session;
  const Readout& readout = vehicle.vehicle->camera.camera.camera.readout;
  const FrameMessage message{request.stamp_ns, request.motion, readout.StampShiftNs()};
  std::optional<FrameSlot> slot = session.BeginFrame(message);
  if (!slot && state.pool.Replace(ClientOf(vehicle.vehicle->id))) {
    slot = session.BeginFrame(message, state.config.queue_timeout_s);
  }
  if (!slot) {
    throw Overload("vehicle_busy", "Another image of this vehicle is being localized; send one at a time.");
  }
  return *std::move(slot);
}

HttpResponse HandleFrame(AppState& state, const HttpRequest& request) {
  const FrameCall call = ParseCall(request);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(*vehicle.vehicle);
  CheckImageHeader(call.image, vehicle.vehicle->camera.camera.camera, state.config.limits.max_image_pixels);
  const std::string client = ClientOf(vehicle.vehicle->id);
  RequireTime(state, MakeLabel(request, client, WorkClass::kTracking));
  const FrameSlot slot = AcquireSlot(state, vehicle, call.request);
  FrameReport report;
  const JobLabel label = MakeLabel(request, client, slot.prior ? WorkClass::kTracking : WorkClass::kSearch);
  const auto queued = std::chrono::steady_clock::now();
  LocalizeJob job{map, {}, call.image, slot.prior, slot.motion, slot.camera_prior, slot.mask};
  const LocalizeOutcome outcome = RunInPool(state, label, [&] {
    const double waited_ms = MillisecondsSince(queued);
    job.camera = VehicleCameraIn(*map, *vehicle.vehicle, state.rectifiers);
    LocalizeOutcome localized = RunLocalization(job);
    const auto fusion = std::chrono::steady_clock::now();
    report = vehicle.session->FinishFrame(slot, localized.features, localized.result, localized.floor);
    localized.queue_ms = waited_ms;
    localized.fusion_ms = MillisecondsSince(fusion);
    return localized;
  });
  state.metrics.CountMessage({map->name, ToString(report.message)});
  LogOdometry(vehicle.vehicle->id, report);
  if (report.fix) {
    CountFix(state, map->name, *report.fix);
  }
  const FrameLabel frame = {vehicle.vehicle->id, UnixTimeNow(), ToSeconds(slot.image_ns), label.work, report.fix};
  return JsonResponse(200, FormatFrameResponse(report, RecordFix(state, job, frame, outcome), outcome));
}

HttpResponse HandleOdometry(AppState& state, const HttpRequest& request) {
  const std::vector<OdometryMessage> increments = ParseOdometryJson(request.body);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(*vehicle.vehicle);
  const OdometryReport report = vehicle.session->AddOdometry(increments);
  for (const MessageOutcome message : report.messages) {
    state.metrics.CountMessage({map->name, ToString(message)});
  }
  return JsonResponse(200, FormatOdometryResponse(report, LabelOf(*map)));
}

HttpResponse HandleInitialPose(AppState& state, const HttpRequest& request) {
  const InitialPoseRequest initial = ParseInitialPoseJson(request.body);
  const VehicleState vehicle = RequireVehicle(state, request.path_parameters.at("id"));
  const auto map = RequireMap(*vehicle.vehicle);
  return JsonResponse(
      200, FormatInitialPoseResponse(vehicle.session->SetPose(initial.pose, initial.stamp_ns), LabelOf(*map)));
}

}  // namespace

void AddTrackingRoutes(AppState& state, Router& router) {
  router.Add({"POST",
              "/v1/vehicles/{id}/frames",
              RouteAccess::kWrite,
              {"image/jpeg", "image/png", "multipart/form-data"},
              [&state](const HttpRequest& request) { return HandleFrame(state, request); },
              [&state](const HttpRequest& head) {
                const std::string client = ClientOf(head.path_parameters.at("id"));
                RequireTime(state, MakeLabel(head, client, WorkClass::kTracking));
              }});
  router.Add({"POST",
              "/v1/vehicles/{id}/odometry",
              RouteAccess::kWrite,
              {"application/json"},
              [&state](const HttpRequest& request) { return HandleOdometry(state, request); }});
  router.Add({"POST",
              "/v1/vehicles/{id}/initialpose",
              RouteAccess::kChange,
              {"application/json"},
              [&state](const HttpRequest& request) { return HandleInitialPose(state, request); }});
}

}  // namespace floorloc
