// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/format_v2.h"

namespace floorloc {
namespace {

using nlohmann::json;

json Header(const MessageHeader& header) { return FormatHeader(header, "2.1.0", 2); }

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
  message["connectionState"] = ToString(state, "CONNECTIONBROKEN");  // one word in this version
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
  return floorloc::FormatActionState(action, "resultDescription");
}

json FormatV2::FormatState(const MessageHeader& header, const StateReport& report) const {
  json message = Header(header);
  AddCommonState(report, *this, "agvPosition", &message);
  message["actionStates"] = FormatActionStates(report.instant_actions);  // this version has one list for all
  message["batteryState"] = {{"batteryCharge", report.charge_percent}, {"charging", false}};
  message["information"] = json::array();
  message["safetyState"] = {{"eStop", "NONE"}, {"fieldViolation", false}};
  return message;
}

}  // namespace floorloc
