// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/format_v3.h"

#include <algorithm>

namespace floorloc {
namespace {

using nlohmann::json;

constexpr double kMaxTheta = 3.14159265359;  // of the published schema; a little more than pi

json Header(const MessageHeader& header) { return FormatHeader(header, "3.0.0", 3); }

}  // namespace

std::string FormatV3::TopicRoot(const VehicleIdentity& identity) const {
  return "vda5050/v3/" + identity.manufacturer + "/" + identity.serial_number;
}

json FormatV3::FormatPosition(const Position& position) const {
  json object = {{"x", position.x},
                 {"y", position.y},
                 {"theta", std::clamp(position.theta, -kMaxTheta, kMaxTheta)},
                 {"mapId", position.map_id},
                 {"localized", position.localized},
                 {"localizationScore", position.score}};
  if (position.deviation_range_m) {
    object["deviationRange"] = *position.deviation_range_m;
  }
  return object;
}

json FormatV3::FormatConnection(const MessageHeader& header, ConnectionState state) const {
  json message = Header(header);
  message["connectionState"] = ToString(state, "CONNECTION_BROKEN");
  return message;
}

json FormatV3::FormatVisualization(const MessageHeader& header, const Position& position,
                                   const std::optional<Velocity>& velocity, std::uint32_t state_header_id) const {
  json message = Header(header);
  message["referenceStateHeaderId"] = state_header_id;
  message["mobileRobotPosition"] = FormatPosition(position);
  if (velocity) {
    message["velocity"] = FormatVelocity(*velocity);
  }
  return message;
}

json FormatV3::FormatActionState(const ActionState& action) const {
  return floorloc::FormatActionState(action, "actionResult");
}

json FormatV3::FormatState(const MessageHeader& header, const StateReport& report) const {
  json message = Header(header);
  AddCommonState(report, *this, "mobileRobotPosition", &message);
  message["actionStates"] = json::array();  // of orders
  message["instantActionStates"] = FormatActionStates(report.instant_actions);
  message["powerSupply"] = {{"stateOfCharge", report.charge_percent}, {"charging", false}};
  message["safetyState"] = {{"activeEmergencyStop", "NONE"}, {"fieldViolation", false}};
  return message;
}

}  // namespace floorloc
