// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/bridge/action_book.h"
#include "server/bridge/bridge_config.h"
#include "server/bridge/instant_actions.h"
#include "server/bridge/localization_monitor.h"
#include "server/bridge/message_format.h"
#include "server/bridge/pose_confirmation.h"
#include "server/bridge/server_task.h"
#include "server/bridge/velocity_estimator.h"

namespace floorloc {

struct OutgoingMessage {
  std::string topic;
  std::string payload;
  int qos = 0;
  bool retain = false;
};

/// One vehicle between floorloc-server and its master control: what comes in changes what is known of it, messages and
/// tasks come out. No threads, no sockets, no clock: times are those of one steady clock, seconds.
class VehicleBridge {
 public:
  struct Outputs {
    std::function<void(const OutgoingMessage&)> publish;
    std::function<bool(ServerTask)> run;  ///< false when too much is to do already
    std::function<double()> unix_time;    ///< for the timestamps of messages
  };

  VehicleBridge(BridgedVehicle vehicle, VdaVersion version, const BehaviourOptions& options, Outputs outputs);

  const BridgedVehicle& vehicle() const { return vehicle_; }
  /// Below which master control and the vehicle's own client publish.
  std::string Topic(const std::string& name) const { return format_.TopicRoot(vehicle_.identity) + "/" + name; }
  std::vector<std::string> Subscriptions() const;
  OutgoingMessage ConnectionMessage(ConnectionState state);

  // The broker.
  void OnBrokerConnected(double now_s);
  /// Whatever it is; what is malformed becomes an error of the vehicle.
  void OnMessage(const std::string& topic, const std::string& payload, double now_s);

  // The server. A vehicle that it does not know has no report.
  void OnServer(bool answers, double now_s);
  void OnSnapshot(const std::optional<VehicleReport>& report, double now_s);
  void OnPose(const PoseReport& report, double now_s);
  void OnStatus(const StatusReport& report, double now_s);
  void OnFix(const FixReport& fix, double now_s);
  void OnMaps(const std::vector<MapEntry>& maps, double now_s);
  void OnTaskResult(const TaskResult& result, double now_s);

  /// To be called some times a second.
  void OnTime(double now_s);

 private:
  struct HeldError {
    VehicleError error;
    double until_s = 0.0;
  };

  void HandleActions(const std::string& payload, double now_s);
  void Handle(const InstantAction& action, double now_s);
  void Begin(const InstantAction& action, const ActionCommand& command, double now_s);
  void HandleOrder(const std::string& payload, double now_s);
  void Apply(const std::optional<ActionVerdict>& verdict, double now_s);
  void Fail(const std::string& action_id, const std::string& sentence, const std::string& error_type, double now_s);
  void Hold(VehicleError error, double now_s);
  std::vector<VehicleError> Errors(double now_s);

  MessageHeader NextHeader(const std::string& topic);
  void Publish(const std::string& topic, const nlohmann::json& message, bool retain);
  void PublishPosition();
  /// What has changed of maps, errors and actions; everything with `all`.
  void PublishChanges(double now_s, bool all);
  void PublishState(double now_s);

  const BridgedVehicle vehicle_;
  const MessageFormat& format_;
  const BehaviourOptions options_;
  const Outputs outputs_;

  LocalizationMonitor monitor_;
  VelocityEstimator velocity_;
  PoseConfirmation confirmation_;
  ActionBook actions_;
  std::optional<std::vector<MapEntry>> maps_;
  std::set<std::string> order_maps_;  // of the last order
  std::vector<HeldError> held_errors_;

  std::map<std::string, std::uint32_t> header_ids_;  // by topic, of the next message
  std::uint32_t state_header_id_ = 0;                // of the latest state
  std::map<std::string, std::string> told_;          // by topic, the latest payload
  std::string told_state_;                           // the latest own state, without what changes all the time
  double next_state_s_ = 0.0;
  bool state_wanted_ = false;
};

}  // namespace floorloc
