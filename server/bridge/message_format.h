// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "server/bridge/protocol.h"

namespace floorloc {

/// The messages of one version of VDA 5050.
class MessageFormat {
 public:
  virtual ~MessageFormat() = default;

  /// Of all topics of a vehicle, without a slash at the end.
  virtual std::string TopicRoot(const VehicleIdentity& identity) const = 0;
  /// agvPosition or mobileRobotPosition.
  virtual nlohmann::json FormatPosition(const Position& position) const = 0;
  virtual nlohmann::json FormatConnection(const MessageHeader& header, ConnectionState state) const = 0;
  /// state_header_id: of the vehicle's latest state.
  virtual nlohmann::json FormatVisualization(const MessageHeader& header, const Position& position,
                                             const std::optional<Velocity>& velocity,
                                             std::uint32_t state_header_id) const = 0;
  virtual nlohmann::json FormatActionState(const ActionState& action) const = 0;
  virtual nlohmann::json FormatState(const MessageHeader& header, const StateReport& report) const = 0;

  // What both versions write alike.
  static nlohmann::json FormatVelocity(const Velocity& velocity);
  static nlohmann::json FormatMaps(const std::vector<MapEntry>& maps);
  static nlohmann::json FormatErrors(const std::vector<VehicleError>& errors);
  nlohmann::json FormatActionStates(const std::vector<ActionState>& actions) const;
};

/// That of a version, for as long as the process lives.
const MessageFormat& FormatOf(VdaVersion version);

/// ISO 8601 in UTC with this number of fractional digits, cut off: "2017-04-15T11:40:03.12Z".
std::string FormatTimestamp(double unix_s, int digits);

// Parts of both formats.
nlohmann::json FormatHeader(const MessageHeader& header, const std::string& version, int fractional_digits);
/// broken: the version's word for ConnectionState::kBroken.
const char* ToString(ConnectionState state, const char* broken);
/// result_key: of what came of the action.
nlohmann::json FormatActionState(const ActionState& action, const char* result_key);
/// The fields of a state that both versions have; position_key: of the position.
void AddCommonState(const StateReport& report, const MessageFormat& format, const char* position_key,
                    nlohmann::json* state);
const char* ToString(ActionStatus status);

}  // namespace floorloc
