// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/message_format.h"

#include <array>
#include <cmath>
#include <ctime>

#include "server/bridge/format_v2.h"
#include "server/bridge/format_v3.h"

namespace floorloc {

using nlohmann::json;

namespace {

// The fields that carry no news while there are no orders.
void AddIdleOrder(json* state) {
  (*state)["orderId"] = "";
  (*state)["orderUpdateId"] = 0;
  (*state)["lastNodeId"] = "";
  (*state)["lastNodeSequenceId"] = 0;
  (*state)["nodeStates"] = json::array();
  (*state)["edgeStates"] = json::array();
}

}  // namespace

json MessageFormat::FormatVelocity(const Velocity& velocity) {
  return {{"vx", velocity.vx}, {"vy", velocity.vy}, {"omega", velocity.omega}};
}

json MessageFormat::FormatMaps(const std::vector<MapEntry>& maps) {
  json list = json::array();
  for (const MapEntry& map : maps) {
    list.push_back(
        {{"mapId", map.id}, {"mapVersion", map.version}, {"mapStatus", map.enabled ? "ENABLED" : "DISABLED"}});
  }
  return list;
}

json MessageFormat::FormatErrors(const std::vector<VehicleError>& errors) {
  json list = json::array();
  for (const VehicleError& error : errors) {
    json references = json::array();
    for (const ErrorReference& reference : error.references) {
      references.push_back({{"referenceKey", reference.key}, {"referenceValue", reference.value}});
    }
    list.push_back({{"errorType", error.type},
                    {"errorLevel", error.level == ErrorLevel::kFatal ? "FATAL" : "WARNING"},
                    {"errorDescription", error.description},
                    {"errorReferences", std::move(references)}});
  }
  return list;
}

json MessageFormat::FormatActionStates(const std::vector<ActionState>& actions) const {
  json list = json::array();
  for (const ActionState& action : actions) {
    list.push_back(FormatActionState(action));
  }
  return list;
}

const MessageFormat& FormatOf(VdaVersion version) {
  static const FormatV2 v2;
  static const FormatV3 v3;
  return version == VdaVersion::kVersion2 ? static_cast<const MessageFormat&>(v2) : v3;
}

std::string FormatTimestamp(double unix_s, int digits) {
  const double scale = std::pow(10.0, digits);
  // Half of a microsecond: what doubles lose of a time is no earlier instant.
  const auto ticks = static_cast<std::int64_t>(std::floor((unix_s + 0.5e-6) * scale));
  const auto per_s = static_cast<std::int64_t>(scale);
  const std::int64_t fraction = ((ticks % per_s) + per_s) % per_s;
  const auto seconds = static_cast<std::time_t>((ticks - fraction) / per_s);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S.", &utc);
  const std::string decimals = std::to_string(fraction);
  return std::string(text.data(), length) + std::string(static_cast<std::size_t>(digits) - decimals.size(), '0') +
         decimals + "Z";
}

json FormatHeader(const MessageHeader& header, const std::string& version, int fractional_digits) {
  return {{"headerId", header.id},
          {"timestamp", FormatTimestamp(header.time_s, fractional_digits)},
          {"version", version},
          {"manufacturer", header.identity.manufacturer},
          {"serialNumber", header.identity.serial_number}};
}

const char* ToString(ConnectionState state, const char* broken) {
  switch (state) {
    case ConnectionState::kOnline:
      return "ONLINE";
    case ConnectionState::kOffline:
      return "OFFLINE";
    case ConnectionState::kBroken:
      return broken;
  }
  return broken;
}

json FormatActionState(const ActionState& action, const char* result_key) {
  json object = {{"actionId", action.id}, {"actionType", action.type}, {"actionStatus", ToString(action.status)}};
  if (!action.result.empty()) {
    object[result_key] = action.result;
  }
  return object;
}

void AddCommonState(const StateReport& report, const MessageFormat& format, const char* position_key, json* state) {
  AddIdleOrder(state);
  (*state)["driving"] = report.driving;
  (*state)["maps"] = MessageFormat::FormatMaps(report.maps);
  (*state)["operatingMode"] = report.operating_mode;
  (*state)["errors"] = MessageFormat::FormatErrors(report.errors);
  if (report.position) {
    (*state)[position_key] = format.FormatPosition(*report.position);
  }
  if (report.velocity) {
    (*state)["velocity"] = MessageFormat::FormatVelocity(*report.velocity);
  }
}

const char* ToString(ActionStatus status) {
  switch (status) {
    case ActionStatus::kRunning:
      return "RUNNING";
    case ActionStatus::kFinished:
      return "FINISHED";
    case ActionStatus::kFailed:
      return "FAILED";
  }
  return "FAILED";
}

}  // namespace floorloc
