// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace floorloc {

/// The largest messages that the bridge reads; orders are the longest.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t{1} << 20;

struct InstantAction {
  std::string id;
  std::string type;
  std::map<std::string, nlohmann::json> parameters;  ///< the first of each key
  std::string misfit;                                ///< a sentence: why it is none; empty: it is well-formed
};

/// The actions of a message of the topic instantActions, of either version; an action that has an id and is otherwise
/// malformed comes with its misfit, so that it can be reported as failed. Unknown fields are ignored, as VDA 5050
/// wants. Throws JsonError with one sentence for a payload that is no such message.
std::vector<InstantAction> ParseInstantActions(const std::string& payload);

/// What an order says of maps.
struct OrderSummary {
  std::string id;
  std::set<std::string> maps;  ///< of its nodes
};

/// Throws JsonError.
OrderSummary ParseOrder(const std::string& payload);

/// The headerId of a message. Throws JsonError.
std::uint32_t ParseHeaderId(const std::string& payload);

struct InitPosition {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;
  std::string map;
};

struct MapVersionName {
  std::string map;
  std::string version;
};

struct DownloadMap {
  MapVersionName map;
  std::string link;
  std::string sha256;  ///< 64 lower-case hexadecimal digits; empty: none was given
};
struct EnableMap {
  MapVersionName map;
};
struct DeleteMap {
  MapVersionName map;
};
struct StateRequest {};
struct ClearInstantActions {};
/// Of another part of the vehicle.
struct OtherAction {};

using ActionCommand =
    std::variant<OtherAction, InitPosition, DownloadMap, EnableMap, DeleteMap, StateRequest, ClearInstantActions>;

/// Whether the bridge takes actions of this type from vehicles that have a client of their own, too.
bool IsOfTheBridge(const std::string& type);

/// Throws JsonError with one sentence that names the parameter.
ActionCommand ParseCommand(const InstantAction& action);

}  // namespace floorloc
