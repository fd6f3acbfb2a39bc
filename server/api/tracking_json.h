// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/serving/fix_history.h"
#include "server/serving/localize_service.h"
#include "server/serving/vehicle_session.h"
#include "server/wire/http_message.h"

namespace floorloc {

/// Parameters of a frames call.
struct FrameRequest {
  std::int64_t stamp_ns = 0;
  std::optional<Pose2> motion;  ///< in the base frame, since the vehicle's previous message
};

/// Body of initialpose; the stamp of the pose is not set.
struct InitialPoseRequest {
  PoseFix pose;
  std::optional<std::int64_t> stamp_ns;
};

/// From the query: stamp, odometry=dx,dy,dyaw. Throws Problem 400 invalid_parameter, or JsonError for numbers that are
/// out of range.
FrameRequest ParseFrameQuery(const HttpRequest& request);
// Parsers of JSON bodies; all throw JsonError.
FrameRequest ParseFrameJson(const std::string& text);
/// One increment, or {"increments":[...]} with at most 1000.
std::vector<OdometryMessage> ParseOdometryJson(const std::string& text);
InitialPoseRequest ParseInitialPoseJson(const std::string& text);

/// {"seconds","metres","radians"}, or null before the first fix.
nlohmann::json FormatSinceFix(const VehicleView& view);

/// {"health","reason","cure","scale","yaw_scale","time_offset_s"}, or null without wheel odometry or before the first
/// fix.
nlohmann::json FormatOdometryTrust(const VehicleView& view);

/// Name and content version of the map that a vehicle is localized in.
struct MapLabel {
  std::string name;
  std::string version;
};

/// Adds "alternatives", where the vehicle may be, if its images do not tell the place on a floor that repeats itself.
void AddAlternatives(const VehicleView& view, const MapLabel& map, nlohmann::json* answer);

std::string FormatFrameResponse(const FrameReport& report, const FixRecord& record, const LocalizeOutcome& outcome);
std::string FormatOdometryResponse(const OdometryReport& report, const MapLabel& map);
std::string FormatInitialPoseResponse(const VehicleView& view, const MapLabel& map);

}  // namespace floorloc
