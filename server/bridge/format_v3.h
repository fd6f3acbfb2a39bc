// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/bridge/message_format.h"

namespace floorloc {

/// VDA 5050 version 3.0.0.
class FormatV3 : public MessageFormat {
 public:
  std::string TopicRoot(const VehicleIdentity& identity) const override;
  nlohmann::json FormatPosition(const Position& position) const override;
  nlohmann::json FormatConnection(const MessageHeader& header, ConnectionState state) const override;
  nlohmann::json FormatVisualization(const MessageHeader& header, const Position& position,
                                     const std::optional<Velocity>& velocity,
                                     std::uint32_t state_header_id) const override;
  nlohmann::json FormatActionState(const ActionState& action) const override;
  nlohmann::json FormatState(const MessageHeader& header, const StateReport& report) const override;
};

}  // namespace floorloc
