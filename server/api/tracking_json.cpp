// SPDX-License-Identifier: Apache-2.0
#include "server/api/tracking_json.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/io/stamp_range.h"
#include "core/io/trajectory.h"
#include "server/api/camera_json.h"
#include "server/api/localize_json.h"
#include "server/api/pose_json.h"
#include "server/wire/number_text.h"
#include "server/wire/problem.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr double kMaxStepM = 100.0;
constexpr double kMaxStepRad = 100.0;
constexpr double kMaxCoordinateM = 1e7;
constexpr std::size_t kMaxIncrements = 1000;

// Default standard deviation of a pose that a person picked on the map.
constexpr double kInitialSigmaM = 0.1;
constexpr double kInitialSigmaRad = 0.1;

// text: as it was sent.
std::int64_t CheckStamp(const std::optional<std::int64_t>& stamp_ns, const std::string& path, const std::string& text) {
  if (!stamp_ns) {
    const std::optional<std::string> unit = HintAboutUnit(text);
    throw JsonError(path + " must be a time in seconds, from -4e9 to 4e9" + (unit ? "; " + *unit : "") + ".");
  }
  return *stamp_ns;
}

// A JSON number, or a string, which keeps more digits than a JSON number.
std::int64_t ReadStamp(JsonObject& object) {
  const std::string path = object.PathOf("stamp");
  if (object.Value("stamp").is_string()) {
    const std::string text = object.Text("stamp");
    return CheckStamp(ParseStampNs(text), path, text);
  }
  return CheckStamp(ToStampNs(object.Number("stamp")), path, object.Value("stamp").dump());
}

Pose2 MakeMotion(const std::vector<double>& step, const std::string& path) {
  const bool plausible =
      std::abs(step[0]) <= kMaxStepM && std::abs(step[1]) <= kMaxStepM && std::abs(step[2]) <= kMaxStepRad;
  if (!plausible) {
    throw JsonError(path + " is too large: at most 100 m and 100 rad since the previous message.");
  }
  return {step[0], step[1], step[2]};
}

Pose2 ReadMotion(JsonObject& object, const std::string& path) {
  return MakeMotion({object.Number("dx"), object.Number("dy"), object.Number("dyaw")}, path);
}

Pose2 ReadMotionObject(JsonObject object) {
  const Pose2 motion = ReadMotion(object, "odometry");
  object.RejectUnknownKeys();
  return motion;
}

// dx, dy, dyaw beside the stamp, or in an object "odometry" as in frames.
OdometryMessage ReadIncrement(JsonObject object, const std::string& path) {
  OdometryMessage message;
  message.stamp_ns = ReadStamp(object);
  message.motion = object.Has("odometry") ? ReadMotionObject(object.Object("odometry")) : ReadMotion(object, path);
  object.RejectUnknownKeys();
  return message;
}

// "dx,dy,dyaw" or {"dx","dy","dyaw"}
Pose2 ParseQueryMotion(const std::string& text) {
  if (text.starts_with('{')) {
    const nlohmann::json json = ParseJson(text);
    return ReadMotionObject({json, "odometry"});
  }
  const std::vector<double> step = ParseNumberList(text);
  if (step.size() != 3) {
    throw Problem(400, "invalid_parameter", "odometry must be three finite numbers dx,dy,dyaw.");
  }
  return MakeMotion(step, "odometry");
}

Eigen::Matrix3d ReadCovariance(JsonObject& object) {
  const std::vector<double> numbers = object.Numbers("covariance");
  if (numbers.size() != 9) {
    throw JsonError("covariance must have 9 numbers, row by row, of x, y and yaw.");
  }
  Eigen::Matrix3d covariance = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  const bool symmetric =
      (covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * covariance.diagonal().cwiseAbs().maxCoeff();
  const bool bounded = covariance.cwiseAbs().maxCoeff() <= kMaxCoordinateM * kMaxCoordinateM;
  if (!symmetric || !bounded || Eigen::LLT<Eigen::Matrix3d>(covariance).info() != Eigen::Success) {
    throw JsonError("covariance must be symmetric and positive definite.");
  }
  return covariance;
}

void AddFused(const VehicleView& view, const MapLabel& map, nlohmann::json& answer) {
  answer["status"] = ToString(view.state());
  answer["epoch"] = view.epoch;
  if (view.lost_reason != LostReason::kNone) {
    answer["lost_reason"] = ToString(view.lost_reason);
  }
  answer["age_s"] = view.silent_s;
  answer["since_fix"] = FormatSinceFix(view);
  answer["odometry"] = FormatOdometryTrust(view);
  answer["next"] = {{"seconds", view.next.seconds}, {"metres", view.next.metres}};
  if (const auto& fused = view.fused) {
    answer["pose"] =
        FormatPose({map.name, map.version, ToSeconds(fused->stamp_ns)}, fused->map_from_base, fused->covariance);
    answer["map_from_odom"] = FormatTransform(fused->map_from_odom);
    answer["odom_from_base"] = FormatTransform(fused->odom_from_base);
  }
  AddAlternatives(view, map, &answer);
}

nlohmann::json FormatVehicleFix(const FrameReport& report, const FixRecord& record) {
  nlohmann::json fix = FormatFix(record);
  fix["status"] = ToString(record.result.status);
  fix["accepted"] = report.fix && report.fix->accepted;
  fix["reanchored"] = report.fix && report.fix->reanchored;
  if (report.fix && !report.fix->accepted) {
    fix["reject_reason"] = ToString(report.fix->reason);
  }
  if (record.result.status == LocalizationStatus::kLocalized) {
    fix["pose"] = FormatFixPose(record);
  } else if (record.result.status == LocalizationStatus::kNotLocalized) {
    fix["reason"] = ToString(record.result.reason);
  }
  return fix;
}

}  // namespace

FrameRequest ParseFrameQuery(const HttpRequest& request) {
  static const std::set<std::string> kKnown = {"stamp", "odometry"};
  for (const auto& [name, value] : request.query) {
    if (!kKnown.contains(name)) {
      throw Problem(400, "invalid_parameter", "'" + name + "' is not a query parameter of frames: stamp, odometry.");
    }
  }
  const std::optional<std::string> stamp = request.QueryValue("stamp");
  if (!stamp || !ParseFinite(*stamp)) {
    throw Problem(400, "invalid_parameter", "stamp must be the time of the image, in seconds.");
  }
  FrameRequest frame;
  frame.stamp_ns = CheckStamp(ParseStampNs(*stamp), "stamp", *stamp);
  if (const std::optional<std::string> odometry = request.QueryValue("odometry")) {
    frame.motion = ParseQueryMotion(*odometry);
  }
  return frame;
}

FrameRequest ParseFrameJson(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  FrameRequest frame;
  frame.stamp_ns = ReadStamp(object);
  if (object.Has("odometry")) {
    frame.motion = ReadMotionObject(object.Object("odometry"));
  }
  object.RejectUnknownKeys();
  return frame;
}

std::vector<OdometryMessage> ParseOdometryJson(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  if (!object.Has("increments")) {
    return {ReadIncrement(object, "The increment")};
  }
  const nlohmann::json& increments = object.Value("increments");
  if (!increments.is_array() || increments.empty() || increments.size() > kMaxIncrements) {
    throw JsonError("increments must be an array of 1 to " + std::to_string(kMaxIncrements) + " objects.");
  }
  object.RejectUnknownKeys();
  std::vector<OdometryMessage> messages;
  for (const nlohmann::json& increment : increments) {
    const std::string path = "increments[" + std::to_string(messages.size()) + "]";
    messages.push_back(ReadIncrement({increment, path}, path));
  }
  return messages;
}

InitialPoseRequest ParseInitialPoseJson(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  const std::vector<double> pose = {object.Number("x"), object.Number("y"), object.Number("yaw")};
  for (const double value : pose) {
    if (std::abs(value) > kMaxCoordinateM) {
      throw JsonError("x, y and yaw must be within 1e7 metres or radians.");
    }
  }
  InitialPoseRequest request;
  request.pose.map_from_base = Pose2(pose[0], pose[1], pose[2]);
  const Eigen::Vector3d sigmas(kInitialSigmaM, kInitialSigmaM, kInitialSigmaRad);
  request.pose.covariance =
      object.Has("covariance") ? ReadCovariance(object) : Eigen::Matrix3d(sigmas.cwiseAbs2().asDiagonal());
  if (object.Has("stamp")) {
    request.stamp_ns = ReadStamp(object);
  }
  object.RejectUnknownKeys();
  return request;
}

nlohmann::json FormatSinceFix(const VehicleView& view) {
  if (!view.fused || !view.fused->since_fix) {
    return nullptr;
  }
  const SinceFix& since = *view.fused->since_fix;
  return {{"seconds", since.seconds}, {"metres", since.metres}, {"radians", since.radians}};
}

nlohmann::json FormatOdometryTrust(const VehicleView& view) {
  if (!view.fused || !view.fused->odometry) {
    return nullptr;
  }
  const OdometryTrust& trust = *view.fused->odometry;
  return {{"health", ToString(trust.health)}, {"reason", ToString(trust.fault)},
          {"cure", CureOf(trust.fault)},      {"scale", trust.scale},
          {"yaw_scale", trust.yaw_scale},     {"time_offset_s", trust.time_offset_s}};
}

void AddAlternatives(const VehicleView& view, const MapLabel& map, nlohmann::json* answer) {
  if (!view.alternatives.empty()) {
    (*answer)["alternatives"] =
        FormatAlternatives({map.name, map.version, ToSeconds(view.alternatives_ns)}, view.alternatives);
  }
}

std::string FormatFrameResponse(const FrameReport& report, const FixRecord& record, const LocalizeOutcome& outcome) {
  nlohmann::json answer;
  AddFused(report.view, {record.map, record.map_version}, answer);
  answer["message"] = ToString(report.message);
  answer["fix"] = FormatVehicleFix(report, record);
  if (!answer.contains("alternatives")) {  // those of the vehicle, by all its images
    answer["alternatives"] = FormatAlternatives(record);
  }
  AddLattice(record, &answer);
  answer["camera_correction"] = FormatCorrection(outcome.correction);
  answer["masked_share"] = outcome.masked_share;
  answer["timing_ms"] = FormatTiming(outcome);
  return ToText(answer);
}

std::string FormatOdometryResponse(const OdometryReport& report, const MapLabel& map) {
  nlohmann::json answer;
  AddFused(report.view, map, answer);
  answer["message"] = ToString(report.messages.back());
  answer["messages"] = nlohmann::json::array();
  for (const MessageOutcome message : report.messages) {
    answer["messages"].push_back(ToString(message));
  }
  return ToText(answer);
}

std::string FormatInitialPoseResponse(const VehicleView& view, const MapLabel& map) {
  nlohmann::json answer;
  AddFused(view, map, answer);
  return ToText(answer);
}

}  // namespace floorloc
