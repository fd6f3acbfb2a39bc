// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/server_reports.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr std::int64_t kMaxCount = std::numeric_limits<std::int64_t>::max();

bool HasValue(JsonObject& object, const std::string& key) { return object.Has(key) && !object.Value(key).is_null(); }

ReportedPose ParsePose(JsonObject object) {
  ReportedPose pose{object.Number("stamp"), object.Number("x"),         object.Number("y"),
                    object.Number("yaw"),   object.Text("map_version"), {}};
  const std::vector<double> covariance = object.Numbers("covariance");
  if (covariance.size() != pose.covariance.size()) {
    throw JsonError(object.PathOf("covariance") + " must have nine numbers.");
  }
  std::copy(covariance.begin(), covariance.end(), pose.covariance.begin());
  return pose;
}

PoseReport ParseLivePose(JsonObject& object, const std::string& id_key) {
  PoseReport report;
  report.vehicle = object.Text(id_key);
  report.map = object.Text("map");
  report.status = object.Text("status");
  if (HasValue(object, "pose")) {
    report.pose = ParsePose(object.Object("pose"));
  }
  report.epoch = object.Integer("epoch", 0, kMaxCount);
  return report;
}

const json& ListOf(JsonObject& object, const std::string& key) {
  const json& list = object.Value(key);
  if (!list.is_array()) {
    throw JsonError(object.PathOf(key) + " must be a list.");
  }
  return list;
}

}  // namespace

PoseReport ParsePoseEvent(const json& data) {
  JsonObject object(data, "pose");
  return ParseLivePose(object, "vehicle");
}

FixReport ParseFix(const json& data) {
  JsonObject object(data, "fix");
  FixReport fix;
  fix.vehicle = HasValue(object, "vehicle") ? object.Text("vehicle") : "";
  fix.sequence = object.Integer("sequence", 0, kMaxCount);
  fix.status = object.Text("status");
  fix.p_wrong = std::clamp(object.Object("fix").Number("p_wrong"), 0.0, 1.0);
  if (object.Has("accepted")) {
    fix.accepted = object.Bool("accepted");
  }
  fix.reanchored = object.Has("reanchored") && object.Bool("reanchored");
  fix.reject_reason = object.Has("reject_reason") ? object.Text("reject_reason") : "";
  if (HasValue(object, "pose")) {
    fix.pose = ParsePose(object.Object("pose"));
  }
  return fix;
}

StatusReport ParseStatusEvent(const json& data) {
  JsonObject object(data, "status");
  return {object.Text("vehicle"), object.Text("status")};
}

VehicleReport ParseVehicle(const json& answer) {
  JsonObject object(answer, "vehicle");
  VehicleReport report{ParseLivePose(object, "id"), std::nullopt};
  if (HasValue(object, "last_fix")) {
    report.last_fix = ParseFix(object.Value("last_fix"));
  }
  return report;
}

std::vector<VehicleReport> ParseVehicleList(const json& answer) {
  JsonObject object(answer, "");
  std::vector<VehicleReport> vehicles;
  for (const json& one : ListOf(object, "vehicles")) {
    vehicles.push_back(ParseVehicle(one));
  }
  return vehicles;
}

std::vector<std::string> ParseReadyMaps(const json& answer) {
  JsonObject object(answer, "");
  std::vector<std::string> names;
  for (const json& one : ListOf(object, "maps")) {
    JsonObject map(one, "maps[]");
    if (map.Text("status") == "ready") {
      names.push_back(map.Text("name"));
    }
  }
  return names;
}

std::vector<MapEntry> ParseVersions(const json& answer) {
  JsonObject object(answer, "");
  const std::string map = object.Text("map");
  const std::string active = HasValue(object, "active") ? object.Text("active") : "";
  std::vector<MapEntry> entries;
  for (const json& one : ListOf(object, "versions")) {
    const std::string version = JsonObject(one, "versions[]").Text("version");
    entries.push_back({map, version, version == active});
  }
  const bool listed = std::any_of(entries.begin(), entries.end(), [](const MapEntry& entry) { return entry.enabled; });
  if (!listed && !active.empty()) {
    entries.insert(entries.begin(), {map, active, true});  // a server that keeps no versions serves the folder's
  }
  return entries;
}

}  // namespace floorloc
