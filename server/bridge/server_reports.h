// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/bridge/protocol.h"

namespace floorloc {

// What floorloc-server says of vehicles and maps, by schema/openapi.yaml. Fields that a newer server adds are ignored;
// all functions throw JsonError with one sentence for what is missing or of another type.

struct ReportedPose {
  double stamp_s = 0.0;
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  std::string map_version;
  std::array<double, 9> covariance = {};
};

/// Of the event pose, and of an item of GET /v1/vehicles.
struct PoseReport {
  std::string vehicle;
  std::string map;
  std::string status;  ///< localized, tracking_odometry, lost or stale
  std::optional<ReportedPose> pose;
  std::int64_t epoch = 0;  ///< grows with each discontinuity of the pose
};

struct FixReport {
  std::string vehicle;  ///< empty: of none
  std::int64_t sequence = 0;
  std::string status;  ///< localized, ambiguous or not_localized
  double p_wrong = 1.0;
  std::optional<bool> accepted;
  bool reanchored = false;  ///< the vehicle's pose was lost, or wrong, and is this one now
  std::string reject_reason;
  std::optional<ReportedPose> pose;
};

struct StatusReport {
  std::string vehicle;
  std::string status;
};

struct VehicleReport {
  PoseReport pose;
  std::optional<FixReport> last_fix;
};

PoseReport ParsePoseEvent(const nlohmann::json& data);
FixReport ParseFix(const nlohmann::json& data);
StatusReport ParseStatusEvent(const nlohmann::json& data);
/// Answers of GET /v1/vehicles and of GET /v1/vehicles/{id}.
std::vector<VehicleReport> ParseVehicleList(const nlohmann::json& answer);
VehicleReport ParseVehicle(const nlohmann::json& answer);
/// Names of the maps that are ready, of GET /v1/maps; and what is kept of one, of GET /v1/maps/{map}/versions: exactly
/// one is enabled, the one that is served.
std::vector<std::string> ParseReadyMaps(const nlohmann::json& answer);
std::vector<MapEntry> ParseVersions(const nlohmann::json& answer);

}  // namespace floorloc
