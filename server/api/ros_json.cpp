// SPDX-License-Identifier: Apache-2.0
#include "server/api/ros_json.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/api/vehicle_json.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr std::int64_t kNsPerS = 1'000'000'000;

// builtin_interfaces/Time: nanosec counts from sec upward, before 1970 too.
json FormatTime(std::int64_t stamp_ns) {
  const std::int64_t nanosec = (stamp_ns % kNsPerS + kNsPerS) % kNsPerS;
  return {{"sec", (stamp_ns - nanosec) / kNsPerS}, {"nanosec", nanosec}};
}

json FormatHeader(std::int64_t stamp_ns, const std::string& frame) {
  return {{"stamp", FormatTime(stamp_ns)}, {"frame_id", frame}};
}

json FormatVector(const Pose2& pose) { return {{"x", pose.x()}, {"y", pose.y()}, {"z", 0.0}}; }

json FormatQuaternion(const Pose2& pose) {
  return {{"x", 0.0}, {"y", 0.0}, {"z", std::sin(pose.yaw() / 2.0)}, {"w", std::cos(pose.yaw() / 2.0)}};
}

// 6x6, row-major, of the 3x3 of (x, y, yaw).
json FormatCovariance(const Eigen::Matrix3d& covariance) {
  constexpr std::array<Eigen::Index, 3> kPlace = {0, 1, 5};
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> all = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>::Zero();
  all(kPlace, kPlace) = covariance;
  return std::vector<double>(all.data(), all.data() + all.size());
}

json FormatTransformStamped(const json& header, const std::string& child, const Pose2& transform) {
  return {{"header", header},
          {"child_frame_id", child},
          {"transform", {{"translation", FormatVector(transform)}, {"rotation", FormatQuaternion(transform)}}}};
}

}  // namespace

json FormatRosVehicle(const VehicleState& state, double stale_after_s) {
  const VehicleView view = state.session->View();
  json answer = FormatLivePose(state, view, stale_after_s);  // its pose gives way to the message
  answer["id"] = state.vehicle->id;
  answer["map"] = state.vehicle->map;
  if (!view.fused) {
    for (const char* message : {"pose", "map_from_base", "map_from_odom", "odom_from_base"}) {
      answer[message] = nullptr;
    }
    return answer;
  }
  const FusedPose& fused = *view.fused;
  const json in_map = FormatHeader(fused.stamp_ns, "map");
  const json pose = {{"position", FormatVector(fused.map_from_base)},
                     {"orientation", FormatQuaternion(fused.map_from_base)}};
  const json with_covariance = {{"pose", pose}, {"covariance", FormatCovariance(fused.covariance)}};
  answer["pose"] = {{"header", in_map}, {"pose", with_covariance}};
  answer["map_from_base"] = FormatTransformStamped(in_map, "base_link", fused.map_from_base);
  answer["map_from_odom"] = FormatTransformStamped(in_map, "odom", fused.map_from_odom);
  answer["odom_from_base"] =
      FormatTransformStamped(FormatHeader(fused.stamp_ns, "odom"), "base_link", fused.odom_from_base);
  return answer;
}

}  // namespace floorloc
