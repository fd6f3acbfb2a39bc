// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/format_v2.h"

namespace floorloc {
namespace {

using nlohmann::json;

json Header(const MessageHeader& header) { return FormatHeader(header, "2.1.0", 2); }

const char* ToText(ConnectionState state) {
  switch (state) {
    case ConnectionState::kOnline:
      return "ONLINE";
    case ConnectionState::kOffline:
      return "OFFLINE";
    case ConnectionState::kBroken:
      return "CONNECTIONBROKEN";  // one word in this version
  }
  return "CONNECTIONBROKEN";
}

}  // namespace

std::string FormatV2::TopicRoot(const VehicleIdentity& identity) const {
  return "uagv/v2/" + identity.manufacturer + "/" + identity.serial_number;
}

json FormatV2::FormatPosition(const Position& position) const {
  json object = {{"x", position.x},
                 {"y", position.y},
                 {"theta", position.theta},
                 {"mapId", position.map_id},
                 {"positionInitialized", position.localized},
                 {"localizationScore", position.score}};
  if (!position.map_description.empty()) {
    object["mapDescription"] = position.map_description;
  }
  if (position.deviation_range_m) {
    object["deviationRange"] = *position.deviation_range_m;
  }
  return object;
}

json FormatV2::FormatConnection(const MessageHeader& header, ConnectionState state) const {
  json message = Header(header);
  message["connectionState"] = ToText(state);
  return message;
}

json FormatV2::FormatVisualization(const MessageHeader& header, const Position& position,
                                   const std::optional<Velocity>& velocity, std::uint32_t /*state_header_id*/) const {
  json message = Header(header);
  message["agvPosition"] = FormatPosition(position);
  message["agvPosition"].erase("mapDescription");  // of the state only
  if (velocity) {
    message["velocity"] = FormatVelocity(*velocity);
  }
  return message;
}

json FormatV2::FormatActionState(const ActionState& action) const {
  json object = {
      {"actionId", action.id}, {"actionType", action.type}, {"actionStatus", floorloc::ToString(action.status)}};
  if (!action.result.empty()) {
    object["resultDescription"] = action.result;
  }
  return object;
}

json FormatV2::FormatState(const MessageHeader& header, const StateReport& report) const {
  json message = Header(header);
  AddIdleOrder(&message);
  message["driving"] = report.driving;
  message["maps"] = FormatMaps(report.maps);
  message["actionStates"] = FormatActionStates(report.instant_actions);  // this version has one list for all
  message["batteryState"] = {{"batteryCharge", report.charge_percent}, {"charging", false}};
  message["operatingMode"] = report.operating_mode;
  message["errors"] = FormatErrors(report.errors);
  message["information"] = json::array();
  message["safetyState"] = {{"eStop", "NONE"}, {"fieldViolation", false}};
  if (report.position) {
    message["agvPosition"] = FormatPosition(*report.position);
  }
  if (report.velocity) {
    message["velocity"] = FormatVelocity(*report.velocity);
  }
  return message;
}

}  // namespace floorloc
