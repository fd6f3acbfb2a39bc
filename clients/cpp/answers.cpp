// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/answers.h"

#include <nlohmann/json.hpp>

namespace floorloc::client {
namespace {

using nlohmann::json;

// The member parsed by a function of its JSON; nothing when it is absent or null.
template <typename Parse>
auto Optional(const json& object, const char* name, Parse parse) -> std::optional<decltype(parse(object))> {
  const auto it = object.find(name);
  if (it == object.end() || it->is_null()) {
    return std::nullopt;
  }
  return parse(*it);
}

Transform ParseTransform(const json& object) {
  return {object.at("x").get<double>(), object.at("y").get<double>(), object.at("yaw").get<double>()};
}

Pose ParsePose(const json& object) {
  Pose pose;
  object.at("map").get_to(pose.map);
  object.at("map_version").get_to(pose.map_version);
  object.at("stamp").get_to(pose.stamp);
  object.at("x").get_to(pose.x);
  object.at("y").get_to(pose.y);
  object.at("yaw").get_to(pose.yaw);
  object.at("covariance").get_to(pose.covariance);
  return pose;
}

std::vector<Alternative> ParseAlternatives(const json& array) {
  std::vector<Alternative> alternatives;
  for (const json& one : array) {
    alternatives.push_back({ParseTransform(one), one.at("inliers").get<int>(), one.at("weight").get<double>()});
  }
  return alternatives;
}

LatticePose ParseLatticePose(const json& object) {
  LatticePose lattice;
  object.at("basis").get_to(lattice.basis);
  lattice.pose = ParseTransform(object.at("pose"));
  object.at("covariance").get_to(lattice.covariance);
  object.at("places").get_to(lattice.places);
  return lattice;
}

void ParseFix(const json& object, Fix* fix) {
  object.at("keypoints").get_to(fix->keypoints);
  object.at("matches").get_to(fix->matches);
  object.at("inliers").get_to(fix->inliers);
  object.at("rms_m").get_to(fix->rms_m);
  object.at("p_wrong").get_to(fix->p_wrong);
  object.at("search").get_to(fix->search);
  fix->support_area = Optional(object, "support_area", [](const json& share) { return share.get<double>(); });
  fix->warning = object.value("warning", "");
}

VehicleFix ParseVehicleFix(const json& object) {
  VehicleFix fix;
  ParseFix(object, &fix);
  object.at("status").get_to(fix.status);
  object.at("accepted").get_to(fix.accepted);
  object.at("reanchored").get_to(fix.reanchored);
  fix.reason = object.value("reason", "");
  fix.reject_reason = object.value("reject_reason", "");
  fix.pose = Optional(object, "pose", ParsePose);
  return fix;
}

Timing ParseTiming(const json& object) { return {object.at("queue").get<double>(), object.at("total").get<double>()}; }

Next ParseNext(const json& object) { return {object.at("seconds").get<double>(), object.at("metres").get<double>()}; }

SinceFix ParseSinceFix(const json& object) {
  return {object.at("seconds").get<double>(), object.at("metres").get<double>(), object.at("radians").get<double>()};
}

OdometryTrust ParseOdometryTrust(const json& object) {
  return {object.at("health").get<std::string>(), object.at("reason").get<std::string>(),
          object.at("cure").get<std::string>()};
}

void ParseTracking(const json& object, TrackingAnswer* answer) {
  object.at("status").get_to(answer->status);
  object.at("epoch").get_to(answer->epoch);
  answer->lost_reason = object.value("lost_reason", "");
  answer->pose = Optional(object, "pose", ParsePose);
  answer->map_from_odom = Optional(object, "map_from_odom", ParseTransform);
  answer->odom_from_base = Optional(object, "odom_from_base", ParseTransform);
  answer->since_fix = Optional(object, "since_fix", ParseSinceFix);
  answer->odometry = Optional(object, "odometry", ParseOdometryTrust);
  answer->alternatives = Optional(object, "alternatives", ParseAlternatives).value_or(std::vector<Alternative>());
  answer->next = ParseNext(object.at("next"));
}

}  // namespace

LocalizeAnswer ParseLocalizeAnswer(const json& object) {
  LocalizeAnswer answer;
  object.at("status").get_to(answer.status);
  answer.reason = object.value("reason", "");
  answer.pose = Optional(object, "pose", ParsePose);
  ParseFix(object.at("fix"), &answer.fix);
  answer.alternatives = ParseAlternatives(object.at("alternatives"));
  answer.lattice = Optional(object, "lattice", ParseLatticePose);
  answer.timing = ParseTiming(object.at("timing_ms"));
  return answer;
}

TrackingAnswer ParseTrackingAnswer(const json& object) {
  TrackingAnswer answer;
  ParseTracking(object, &answer);
  return answer;
}

OdometryAnswer ParseOdometryAnswer(const json& object) {
  OdometryAnswer answer;
  ParseTracking(object, &answer);
  object.at("message").get_to(answer.message);
  object.at("messages").get_to(answer.messages);
  return answer;
}

FrameAnswer ParseFrameAnswer(const json& object) {
  FrameAnswer answer;
  ParseTracking(object, &answer);
  object.at("message").get_to(answer.message);
  answer.fix = ParseVehicleFix(object.at("fix"));
  answer.lattice = Optional(object, "lattice", ParseLatticePose);
  answer.timing = ParseTiming(object.at("timing_ms"));
  return answer;
}

}  // namespace floorloc::client
