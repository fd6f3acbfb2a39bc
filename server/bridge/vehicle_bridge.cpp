// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/vehicle_bridge.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxHeldErrors = 20;

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <typename... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

bool HasMap(const std::vector<MapEntry>& maps, const std::string& id) {
  return std::any_of(maps.begin(), maps.end(), [&](const MapEntry& map) { return map.id == id; });
}

}  // namespace

VehicleBridge::VehicleBridge(BridgedVehicle vehicle, VdaVersion version, const BehaviourOptions& options,
                             Outputs outputs)
    : vehicle_(std::move(vehicle)),
      format_(FormatOf(version)),
      options_(options),
      outputs_(std::move(outputs)),
      monitor_(options.lost_after_s) {}

std::vector<std::string> VehicleBridge::Subscriptions() const {
  std::vector<std::string> topics = {Topic("instantActions"), Topic("order")};
  if (!vehicle_.own_state) {
    topics.push_back(Topic("state"));
  }
  return topics;
}

OutgoingMessage VehicleBridge::ConnectionMessage(ConnectionState state) {
  const std::string topic = Topic("connection");
  return {topic, ToText(format_.FormatConnection(NextHeader(topic), state)), 1, true};
}

void VehicleBridge::OnBrokerConnected(double now_s) {
  outputs_.publish(ConnectionMessage(ConnectionState::kOnline));
  PublishPosition();
  PublishChanges(now_s, true);
}

void VehicleBridge::OnMessage(const std::string& topic, const std::string& payload, double now_s) {
  try {
    if (topic == Topic("instantActions")) {
      HandleActions(payload, now_s);
    } else if (topic == Topic("order")) {
      HandleOrder(payload, now_s);
    } else if (topic == Topic("state")) {
      state_header_id_ = ParseHeaderId(payload);
    }
  } catch (const JsonError& error) {
    // What the vehicle's own client says is its own affair.
    if (topic != Topic("state")) {
      Hold({kValidationFailure, ErrorLevel::kWarning, error.what(), {{"topic", topic}}}, now_s);
    }
  }
  PublishChanges(now_s, false);
}

void VehicleBridge::HandleActions(const std::string& payload, double now_s) {
  for (const InstantAction& action : ParseInstantActions(payload)) {
    Handle(action, now_s);
  }
}

void VehicleBridge::Handle(const InstantAction& action, double now_s) {
  if (actions_.Knows(action.id)) {
    return;  // sent once more: VDA 5050 identifies actions by their ids
  }
  if (!vehicle_.own_state && !IsOfTheBridge(action.type)) {
    return;  // the vehicle's own client takes it
  }
  ActionCommand command;
  std::string misfit = action.misfit;
  if (misfit.empty()) {
    try {
      command = ParseCommand(action);
    } catch (const JsonError& error) {
      misfit = error.what();
    }
  }
  if (!actions_.Add({action.id, action.type, ActionStatus::kRunning, ""})) {
    Hold({kInvalidInstantAction,
          ErrorLevel::kWarning,
          "Too many instant actions are running.",
          {{"actionId", action.id}}},
         now_s);
  } else if (!misfit.empty()) {
    Fail(action.id, misfit, kInvalidInstantAction, now_s);
  } else {
    Begin(action, command, now_s);
  }
}

void VehicleBridge::Begin(const InstantAction& action, const ActionCommand& command, double now_s) {
  const auto run = [&] {
    if (!outputs_.run({vehicle_.id, action.id, command})) {
      Fail(action.id, "The bridge has too much to do; send the action again later.", kInvalidInstantAction, now_s);
    }
  };
  const auto on_map = [&](const MapVersionName& map, bool wanted) {
    const auto found =
        maps_ ? std::find_if(maps_->begin(), maps_->end(),
                             [&](const MapEntry& entry) { return entry.id == map.map && entry.version == map.version; })
              : std::vector<MapEntry>::iterator{};
    const bool there = maps_ && found != maps_->end();
    if (maps_ && there != wanted) {
      Fail(action.id, wanted ? "The server has no such version of the map." : "The server has this version already.",
           wanted ? kUnknownMapId : kDuplicateMap, now_s);
    } else if (there && found->enabled && std::holds_alternative<DeleteMap>(command)) {
      Fail(action.id, "This version of the map is in use: enable another one first.", kInvalidInstantAction, now_s);
    } else {
      run();
    }
  };
  std::visit(Overloaded{[&](const OtherAction&) {
                          Fail(action.id, "'" + action.type + "' is no action of this vehicle.", kInvalidInstantAction,
                               now_s);
                        },
                        [&](const InitPosition& init) {
                          if (maps_ && !HasMap(*maps_, init.map)) {
                            Fail(action.id, "The server has no map '" + init.map + "'.", kUnknownMapId, now_s);
                          } else {
                            run();
                          }
                        },
                        [&](const DownloadMap& download) { on_map(download.map, false); },
                        [&](const EnableMap& enable) { on_map(enable.map, true); },
                        [&](const DeleteMap& remove) { on_map(remove.map, true); },
                        [&](const StateRequest&) {
                          actions_.End(action.id, ActionStatus::kFinished, "");
                          state_wanted_ = true;
                        },
                        [&](const ClearInstantActions&) {
                          actions_.Clear();
                          actions_.End(action.id, ActionStatus::kFinished, "");
                        }},
             command);
}

void VehicleBridge::HandleOrder(const std::string& payload, double now_s) {
  OrderSummary order = ParseOrder(payload);
  order_maps_ = std::move(order.maps);
  if (vehicle_.own_state) {
    Hold({kInvalidOrder,
          ErrorLevel::kWarning,
          "This vehicle takes no orders: floorloc-bridge only tells where it is.",
          {{"orderId", order.id}}},
         now_s);
  }
}

void VehicleBridge::OnServer(bool answers, double now_s) {
  monitor_.OnServer(answers, now_s);
  if (!answers) {
    velocity_.Reset();
  }
  PublishPosition();
}

void VehicleBridge::OnSnapshot(const std::optional<VehicleReport>& report, double now_s) {
  monitor_.OnKnown(report.has_value(), now_s);
  if (!report) {
    PublishPosition();
    return;
  }
  if (report->last_fix) {
    OnFix(*report->last_fix, now_s);
  }
  OnPose(report->pose, now_s);
}

void VehicleBridge::OnPose(const PoseReport& report, double now_s) {
  monitor_.OnPose(report, now_s);
  velocity_.Add(report);
  PublishPosition();
}

void VehicleBridge::OnStatus(const StatusReport& report, double now_s) {
  monitor_.OnStatus(report.status, now_s);
  PublishPosition();
}

void VehicleBridge::OnFix(const FixReport& fix, double now_s) {
  monitor_.OnFix(fix);
  Apply(confirmation_.OnFix(fix), now_s);
}

void VehicleBridge::OnMaps(const std::vector<MapEntry>& maps, double now_s) {
  maps_ = maps;
  PublishChanges(now_s, false);
}

void VehicleBridge::OnTaskResult(const TaskResult& result, double now_s) {
  if (result.maps) {
    maps_ = result.maps;
  }
  if (!result.succeeded) {
    Fail(result.action_id, result.sentence, result.error_type, now_s);
  } else if (result.pose) {
    Apply(confirmation_.Start(result.action_id, {*result.pose, result.last_fix, now_s + options_.confirm_within_s}),
          now_s);
  } else {
    actions_.End(result.action_id, ActionStatus::kFinished, result.sentence);
  }
  PublishChanges(now_s, false);
}

void VehicleBridge::Apply(const std::optional<ActionVerdict>& verdict, double now_s) {
  if (!verdict) {
    return;
  }
  if (verdict->succeeded) {
    actions_.End(verdict->action_id, ActionStatus::kFinished, verdict->sentence);
  } else {
    Fail(verdict->action_id, verdict->sentence, kInvalidInstantAction, now_s);
  }
  PublishChanges(now_s, false);
}

void VehicleBridge::Fail(const std::string& action_id, const std::string& sentence, const std::string& error_type,
                         double now_s) {
  actions_.End(action_id, ActionStatus::kFailed, sentence);
  Hold({error_type, ErrorLevel::kWarning, sentence, {{"actionId", action_id}}}, now_s);
}

void VehicleBridge::Hold(VehicleError error, double now_s) {
  std::erase_if(held_errors_, [&](const HeldError& held) { return held.error == error; });
  if (held_errors_.size() >= kMaxHeldErrors) {
    held_errors_.erase(held_errors_.begin());
  }
  held_errors_.push_back({std::move(error), now_s + options_.error_hold_s});
}

std::vector<VehicleError> VehicleBridge::Errors(double now_s) {
  std::vector<VehicleError> errors;
  if (auto lost = monitor_.Error(now_s)) {
    errors.push_back(std::move(*lost));
  }
  std::set<std::string> wanted = order_maps_;
  if (!monitor_.map().empty()) {
    wanted.insert(monitor_.map());
  }
  for (const std::string& map : wanted) {
    if (maps_ && !HasMap(*maps_, map)) {
      errors.push_back({kUnknownMapId,
                        ErrorLevel::kWarning,
                        "floorloc-server has no map '" + map + "' that is ready.",
                        {{"mapId", map}}});
    }
  }
  std::erase_if(held_errors_, [&](const HeldError& held) { return held.until_s < now_s; });
  for (const HeldError& held : held_errors_) {
    errors.push_back(held.error);
  }
  return errors;
}

void VehicleBridge::OnTime(double now_s) {
  Apply(confirmation_.OnTime(now_s), now_s);
  PublishChanges(now_s, false);
}

MessageHeader VehicleBridge::NextHeader(const std::string& topic) {
  return {header_ids_[topic]++, outputs_.unix_time(), vehicle_.identity};
}

void VehicleBridge::Publish(const std::string& topic, const json& message, bool retain) {
  outputs_.publish({topic, ToText(message), retain ? 1 : 0, retain});
}

void VehicleBridge::PublishPosition() {
  const std::optional<Position> position = monitor_.position();
  if (!position) {
    return;
  }
  const std::optional<Velocity> velocity = velocity_.velocity();
  const std::string own = "floorloc/v1/" + vehicle_.id;
  Publish(own + "/position", format_.FormatPosition(*position), false);
  if (velocity) {
    Publish(own + "/velocity", MessageFormat::FormatVelocity(*velocity), false);
  }
  const std::string topic = Topic("visualization");
  Publish(topic, format_.FormatVisualization(NextHeader(topic), *position, velocity, state_header_id_), false);
}

void VehicleBridge::PublishChanges(double now_s, bool all) {
  const auto tell = [&](const std::string& name, const json& value) {
    const std::string topic = "floorloc/v1/" + vehicle_.id + "/" + name;
    std::string text = ToText(value);
    if (all || told_[topic] != text) {
      outputs_.publish({topic, text, 1, true});
      told_[topic] = std::move(text);
    }
  };
  if (maps_) {
    tell("maps", MessageFormat::FormatMaps(*maps_));
  }
  tell("errors", MessageFormat::FormatErrors(Errors(now_s)));
  tell("actionStates", format_.FormatActionStates(actions_.actions()));
  if (vehicle_.own_state) {
    state_wanted_ = state_wanted_ || all;
    PublishState(now_s);
  }
}

void VehicleBridge::PublishState(double now_s) {
  StateReport report;
  report.position = monitor_.position();
  report.velocity = velocity_.velocity();
  report.driving = report.velocity && (std::hypot(report.velocity->vx, report.velocity->vy) > options_.driving_above ||
                                       std::abs(report.velocity->omega) > options_.driving_above);
  report.maps = maps_.value_or(std::vector<MapEntry>{});
  report.instant_actions = actions_.actions();
  report.errors = Errors(now_s);
  report.operating_mode = options_.operating_mode;
  report.charge_percent = options_.charge_percent;
  const std::string news =
      ToText({report.driving, report.position && report.position->localized, MessageFormat::FormatMaps(report.maps),
              MessageFormat::FormatErrors(report.errors), format_.FormatActionStates(report.instant_actions)});
  if (!state_wanted_ && news == told_state_ && now_s < next_state_s_) {
    return;
  }
  const std::string topic = Topic("state");
  const MessageHeader header = NextHeader(topic);
  state_header_id_ = header.id;
  Publish(topic, format_.FormatState(header, report), false);
  told_state_ = news;
  state_wanted_ = false;
  next_state_s_ = now_s + options_.state_period_s;
}

}  // namespace floorloc
