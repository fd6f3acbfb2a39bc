// SPDX-License-Identifier: Apache-2.0
#include "server/api/localize_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/io/jpeg_quality.h"
#include "server/api/camera_json.h"
#include "server/api/inspection_json.h"
#include "server/wire/names.h"
#include "server/wire/number_text.h"
#include "server/wire/problem.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr double kMaxCoordinateM = 1e7;
constexpr double kMaxSpeed = 100.0;

PosePrior MakePrior(const std::vector<double>& numbers, const std::optional<double>& radius_m) {
  if (numbers.size() != 3 || std::abs(numbers[0]) > kMaxCoordinateM || std::abs(numbers[1]) > kMaxCoordinateM ||
      std::abs(numbers[2]) > kMaxCoordinateM) {
    throw JsonError("prior must be three finite numbers x,y,yaw (metres, metres, radians).");
  }
  PosePrior prior;
  prior.map_from_base = Pose2(numbers[0], numbers[1], numbers[2]);
  if (radius_m) {
    if (*radius_m <= 0.0 || *radius_m > kMaxCoordinateM) {
      throw JsonError("radius must be a positive number of metres.");
    }
    prior.radius_m = *radius_m;
  }
  return prior;
}

Eigen::Vector3d MakeTwist(const std::vector<double>& numbers) {
  const bool plausible = numbers.size() == 3 && std::abs(numbers[0]) <= kMaxSpeed &&
                         std::abs(numbers[1]) <= kMaxSpeed && std::abs(numbers[2]) <= kMaxSpeed;
  if (!plausible) {
    throw JsonError("twist must be three numbers vx,vy,wz (m/s, m/s, rad/s) within +-100.");
  }
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Vector3d ParseTwistObject(JsonObject twist) {
  const std::vector<double> numbers = {twist.Number("vx"), twist.Number("vy"), twist.Number("wz")};
  twist.RejectUnknownKeys();
  return MakeTwist(numbers);
}

// "x,y,yaw", [x, y, yaw] or {"x","y","yaw"}
std::vector<double> ParsePriorValue(JsonObject& object) {
  const nlohmann::json& value = object.Value("prior");
  if (value.is_string()) {
    return ParseNumberList(value.get_ref<const std::string&>());
  }
  if (value.is_array()) {
    return ReadNumbers(value, "prior");
  }
  JsonObject pose(value, "prior");
  std::vector<double> numbers = {pose.Number("x"), pose.Number("y"), pose.Number("yaw")};
  pose.RejectUnknownKeys();
  return numbers;
}

void CheckComplete(const LocalizeRequest& request, bool has_radius) {
  if (has_radius && !request.prior) {
    throw JsonError("radius only makes sense with prior.");
  }
  if (request.vehicle.empty() && !request.camera) {
    throw JsonError("vehicle is missing: name a registered vehicle, or send camera and floor.");
  }
  if (!request.vehicle.empty() && !request.mask.empty()) {
    throw JsonError("mask belongs to an inline camera; a vehicle registers its own.");
  }
  if (!request.vehicle.empty() && (request.camera || !IsVehicleId(request.vehicle))) {
    throw JsonError("vehicle must be an id of letters, digits, '_', '.' and '-', and excludes camera and floor.");
  }
}

std::optional<double> QueryNumber(const HttpRequest& request, const std::string& name) {
  const std::optional<std::string> text = request.QueryValue(name);
  const std::optional<double> value = text ? ParseFinite(*text) : std::nullopt;
  if (text && !value) {
    throw JsonError(name + " must be a finite number.");
  }
  return value;
}

LocalizeRequest ReadQuery(const HttpRequest& request) {
  static const std::set<std::string> kKnown = {"vehicle", "prior", "radius", "twist", "stamp", "inspect"};
  for (const auto& [name, value] : request.query) {
    if (!kKnown.contains(name)) {
      throw JsonError("'" + name +
                      "' is not a query parameter of localize: vehicle, prior, radius, twist, stamp, inspect.");
    }
  }
  LocalizeRequest localize;
  localize.vehicle = request.QueryValue("vehicle").value_or("");
  localize.stamp_s = QueryNumber(request, "stamp");
  const std::optional<double> radius_m = QueryNumber(request, "radius");
  if (const std::optional<std::string> prior = request.QueryValue("prior")) {
    localize.prior = MakePrior(ParseNumberList(*prior), radius_m);
  }
  if (const std::optional<std::string> twist = request.QueryValue("twist")) {
    localize.twist = MakeTwist(ParseNumberList(*twist));
  }
  if (const std::optional<std::string> inspect = request.QueryValue("inspect")) {
    localize.inspect = *inspect == "true";
    if (!localize.inspect && *inspect != "false") {
      throw JsonError("inspect is true or false.");
    }
  }
  CheckComplete(localize, radius_m.has_value());
  return localize;
}

PoseLabel LabelOf(const FixRecord& record) { return {record.map, record.map_version, record.stamp_s}; }

void AddStatus(const FixRecord& record, nlohmann::json& answer) {
  answer["status"] = ToString(record.result.status);
  if (record.result.status == LocalizationStatus::kLocalized) {
    answer["pose"] = FormatFixPose(record);
  } else if (record.result.status == LocalizationStatus::kNotLocalized) {
    answer["reason"] = ToString(record.result.reason);
  }
  answer["fix"] = FormatFix(record);
  answer["alternatives"] = FormatAlternatives(record);
  AddLattice(record, &answer);
}

}  // namespace

LocalizeRequest ParseLocalizeQuery(const HttpRequest& request) {
  try {
    return ReadQuery(request);
  } catch (const JsonError& error) {
    throw Problem(400, "invalid_parameter", error.what());
  }
}

LocalizeRequest ParseLocalizeJson(const std::string& text) {
  const nlohmann::json json = ParseJson(text, kMaxJsonBytesWithMask);
  JsonObject object(json, "");
  LocalizeRequest request;
  if (object.Has("vehicle")) {
    request.vehicle = object.Text("vehicle");
  }
  if (object.Has("camera") || object.Has("floor")) {
    request.camera = FloorCamera{ParseCamera(object.Value("camera")), ParseFloor(object.Value("floor"))};
  }
  if (object.Has("mask")) {
    request.mask = ParseCameraMask(object.Text("mask"));
  }
  if (object.Has("correct_camera")) {
    request.correct = object.Bool("correct_camera");
  }
  if (object.Has("stamp")) {
    request.stamp_s = object.Number("stamp");
  }
  const bool has_radius = object.Has("radius");
  const std::optional<double> radius_m = has_radius ? std::optional(object.Number("radius")) : std::nullopt;
  if (object.Has("prior")) {
    request.prior = MakePrior(ParsePriorValue(object), radius_m);
  }
  if (object.Has("twist")) {
    request.twist = ParseTwistObject(object.Object("twist"));
  }
  if (object.Has("inspect")) {
    request.inspect = object.Bool("inspect");
  }
  object.RejectUnknownKeys();
  CheckComplete(request, has_radius);
  return request;
}

nlohmann::json FormatFixPose(const FixRecord& record) {
  return FormatPose(LabelOf(record), record.result.map_from_base, record.result.covariance);
}

nlohmann::json FormatFix(const FixRecord& record) {
  const LocalizationResult& r = record.result;
  nlohmann::json fix = {{"keypoints", r.keypoints}, {"matches", r.matches}, {"inliers", r.inliers},
                        {"rms_m", r.rms_m},         {"p_wrong", r.p_wrong}, {"search", record.search}};
  if (r.support_area) {
    fix["support_area"] = *r.support_area;
  }
  if (r.poor_jpeg_quality) {
    fix["jpeg_quality"] = *r.poor_jpeg_quality;
    if (r.status == LocalizationStatus::kNotLocalized) {
      fix["warning"] = CompressedTooMuch(*r.poor_jpeg_quality);
    }
  }
  return fix;
}

nlohmann::json FormatAlternatives(const FixRecord& record) {
  return FormatAlternatives(LabelOf(record), record.result.alternatives);
}

nlohmann::json FormatAlternatives(const PoseLabel& label, const std::vector<PoseHypothesis>& hypotheses) {
  nlohmann::json alternatives = nlohmann::json::array();
  for (const PoseHypothesis& hypothesis : hypotheses) {
    nlohmann::json item = FormatPose(label, hypothesis.target_from_source);
    item["inliers"] = hypothesis.inliers;
    item["weight"] = hypothesis.weight;
    alternatives.push_back(std::move(item));
  }
  return alternatives;
}

void AddLattice(const FixRecord& record, nlohmann::json* answer) {
  if (!record.result.lattice) {
    return;
  }
  const LatticeObservation& seen = *record.result.lattice;
  const Eigen::Matrix2d& basis = seen.lattice.basis;
  (*answer)["lattice"] = {{"basis", {{basis(0, 0), basis(1, 0)}, {basis(0, 1), basis(1, 1)}}},
                          {"pose", FormatTransform(seen.map_from_base)},
                          {"covariance", FormatCovariance(seen.covariance)},
                          {"places", seen.CountPlaces()}};
}

nlohmann::json FormatTiming(const LocalizeOutcome& outcome) {
  const LocalizationTiming& timing = outcome.result.timing;
  nlohmann::json json = {{"queue", outcome.queue_ms},    {"decode", outcome.decode_ms},
                         {"rectify", timing.rectify_ms}, {"features", timing.features_ms},
                         {"match", timing.match_ms},     {"register", timing.register_ms},
                         {"total", outcome.total_ms}};
  if (outcome.fusion_ms) {
    json["fusion"] = *outcome.fusion_ms;
  }
  return json;
}

std::string FormatLocalizeResponse(const FixRecord& record, const LocalizeOutcome& outcome) {
  nlohmann::json answer;
  AddStatus(record, answer);
  answer["camera_correction"] = FormatCorrection(outcome.correction);
  answer["timing_ms"] = FormatTiming(outcome);
  if (outcome.inspection) {
    answer["inspection"] = FormatInspection(*outcome.inspection);
  }
  return ToText(answer);
}

nlohmann::json FormatFixRecord(const FixRecord& record) {
  nlohmann::json json = {{"sequence", record.sequence},
                         {"received", record.received_s},
                         {"stamp", record.stamp_s},
                         {"vehicle", record.vehicle.empty() ? nlohmann::json() : nlohmann::json(record.vehicle)}};
  AddStatus(record, json);
  if (record.outcome) {
    json["accepted"] = record.outcome->accepted;
    json["reanchored"] = record.outcome->reanchored;
    if (!record.outcome->accepted) {
      json["reject_reason"] = ToString(record.outcome->reason);
    }
  }
  return json;
}

std::string FormatFixList(const std::vector<FixRecord>& records, std::uint64_t next) {
  nlohmann::json fixes = nlohmann::json::array();
  for (const FixRecord& record : records) {
    fixes.push_back(FormatFixRecord(record));
  }
  return ToText({{"fixes", std::move(fixes)}, {"next", next}});
}

}  // namespace floorloc
