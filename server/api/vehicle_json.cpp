// SPDX-License-Identifier: Apache-2.0
#include "server/api/vehicle_json.h"

#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/trajectory.h"
#include "server/api/camera_json.h"
#include "server/api/image_call.h"
#include "server/api/localize_json.h"
#include "server/api/pose_json.h"
#include "server/api/tracking_json.h"
#include "server/serving/localize_service.h"
#include "server/wire/strict_json.h"
#include "server/wire/unix_time.h"

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

nlohmann::json FormatSummary(const VehicleState& state, const VehicleView& view, double stale_after_s) {
  nlohmann::json json = FormatLivePose(state, view, stale_after_s);
  json["id"] = state.vehicle->id;
  json["map"] = state.vehicle->map;
  json["odometry"] = FormatOdometryTrust(view);
  json["last_heard"] = UnixTimeNow() - view.silent_s;
  json["last_fix"] = state.last_fix ? FormatFixRecord(*state.last_fix) : nlohmann::json();
  return json;
}

// The vehicle's own mask, or that which its map has of its camera.
nlohmann::json FormatMask(const Vehicle& vehicle) {
  const Rectifier& rectifier = *vehicle.in_map.rectifier;
  if (rectifier.raw_mask().empty()) {
    return {};
  }
  return {{"masked_share", rectifier.masked_share()}, {"of", vehicle.camera.mask.empty() ? "map" : "vehicle"}};
}

// The registered camera, and what of its view is not looked at.
nlohmann::json FormatVehicleCamera(const Vehicle& vehicle, const LearnedMaskState& learnt) {
  const Rectifier& rectifier = *vehicle.in_map.rectifier;
  nlohmann::json json = FormatCamera(vehicle.camera.camera.camera);
  nlohmann::json by = nlohmann::json::array();
  if (!rectifier.raw_mask().empty()) {
    by.push_back(vehicle.camera.mask.empty() ? "map" : "registration");
  }
  if (!learnt.left_out.empty()) {
    by.push_back("learnt");
  }
  json["masked_share"] = MaskedShare(rectifier, learnt);
  json["masked_by"] = std::move(by);
  json["learnt_mask"] = {{"status", ToString(learnt.status)}, {"share", learnt.share}, {"pairs", learnt.pairs}};
  return json;
}

nlohmann::json FormatMessageCounts(const VehicleCounts& counts) {
  nlohmann::json json;
  for (const MessageOutcome outcome : counts.messages.Values()) {
    json[ToString(outcome)] = counts.messages[outcome];
  }
  return json;
}

nlohmann::json FormatFixCounts(const VehicleCounts& counts) {
  nlohmann::json rejected;
  for (const FixRejection reason : counts.rejected.Values()) {
    if (reason != FixRejection::kNone) {
      rejected[ToString(reason)] = counts.rejected[reason];
    }
  }
  return {{"accepted", counts.accepted}, {"reanchored", counts.reanchored}, {"rejected", std::move(rejected)}};
}

// camera: as the errors are relative to.
nlohmann::json FormatCameraEstimate(const CameraEstimate& estimate, const FloorCamera& camera) {
  const CameraErrors& errors = estimate.errors.mean;
  const CameraErrors sigmas = estimate.errors.covariance.diagonal().cwiseSqrt();
  const auto mounting = [](const CameraErrors& e) {
    return nlohmann::json{{"roll", e(0)}, {"pitch", e(1)}, {"height_share", e(2)}};
  };
  nlohmann::json json = mounting(errors);
  json["sigma"] = mounting(sigmas);
  json["status"] = ToString(estimate.status);
  json["fixes"] = estimate.fixes;
  json["off_px"] = LargestDisplacementPx(camera, errors);
  json["readout_s"] = estimate.readout ? nlohmann::json(estimate.readout->seconds) : nlohmann::json();
  json["readout_sigma_s"] = estimate.readout ? nlohmann::json(estimate.readout->sigma_s) : nlohmann::json();
  return json;
}

}  // namespace

VehicleRequest ParseVehicleRequest(const std::string& text) {
  const nlohmann::json json = ParseJson(text, kMaxJsonBytesWithMask);
  JsonObject object(json, "");
  VehicleRequest request;
  request.map = object.Text("map");
  request.camera.camera = {ParseCamera(object.Value("camera")), ParseFloor(object.Value("floor"))};
  if (object.Has("mask")) {
    request.camera.mask = ParseCameraMask(object.Text("mask"));
  }
  if (object.Has("correct_camera")) {
    request.camera.correct = object.Bool("correct_camera");
  }
  if (object.Has("gate")) {
    request.gate = ParseGate(object.Object("gate"));
  }
  object.RejectUnknownKeys();
  return request;
}

std::string StatusOf(const VehicleView& view, double stale_after_s) {
  const bool stale = view.silent_s > stale_after_s && view.state() != TrackingState::kLost;
  return stale ? kStaleStatus : ToString(view.state());
}

Vehicle MakeVehicle(const std::string& id, VehicleRequest request) {
  Vehicle vehicle;
  vehicle.id = id;
  vehicle.map = std::move(request.map);
  vehicle.gate = request.gate;
  vehicle.camera = std::move(request.camera);
  return vehicle;
}

nlohmann::json FormatLivePose(const VehicleState& state, const VehicleView& view, double stale_after_s) {
  const MapInfo* map = InfoOf(state.vehicle->served);
  const PoseLabel label = {state.vehicle->map, map != nullptr ? map->content_version : "",
                           view.fused ? ToSeconds(view.fused->stamp_ns) : 0.0};
  nlohmann::json json = {
      {"status", StatusOf(view, stale_after_s)},
      {"pose", view.fused ? FormatPose(label, view.fused->map_from_base, view.fused->covariance) : nlohmann::json()},
      {"silent_s", view.silent_s},
      {"epoch", view.epoch}};
  if (view.lost_reason != LostReason::kNone) {
    json["lost_reason"] = ToString(view.lost_reason);
  }
  AddAlternatives(view, {label.map, label.map_version}, &json);
  return json;
}

nlohmann::json FormatVehicle(const VehicleState& state, double stale_after_s) {
  const Vehicle& vehicle = *state.vehicle;
  const MapInfo* map = InfoOf(vehicle.served);
  const VehicleView view = state.session->View();
  nlohmann::json json = FormatSummary(state, view, stale_after_s);
  json["camera"] = FormatVehicleCamera(vehicle, state.session->Mask());
  json["floor"] = FormatFloor(vehicle.camera.camera.floor);
  json["correct_camera"] = vehicle.camera.correct;
  json["camera_correction"] = FormatCorrection(map != nullptr ? CorrectionOf(*map, vehicle.camera) : std::nullopt);
  json["camera_estimate"] = FormatCameraEstimate(state.session->Camera(), vehicle.in_map.rectifier->camera());
  json["mask"] = FormatMask(vehicle);
  json["gate"] = {{"max_distance_m", vehicle.gate.max_distance_m}, {"max_angle_rad", vehicle.gate.max_angle_rad}};
  json["since_fix"] = FormatSinceFix(view);
  json["messages"] = FormatMessageCounts(view.counts);
  json["fixes"] = FormatFixCounts(view.counts);
  return json;
}

nlohmann::json FormatVehicleSummary(const VehicleState& state, double stale_after_s) {
  nlohmann::json json = FormatSummary(state, state.session->View(), stale_after_s);
  json["camera_status"] = ToString(state.session->Camera().status);
  return json;
}

}  // namespace floorloc
