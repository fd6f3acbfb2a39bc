// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/instant_actions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/wire/names.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxActions = 100;  // of a message
constexpr std::size_t kMaxTextLength = 256;
constexpr double kMaxCoordinateM = 1e6;
constexpr double kThetaTolerance = 1e-6;  // pi, rounded by others

std::string ShortText(JsonObject& object, const std::string& key) {
  std::string text = object.Text(key);
  if (text.empty() || text.size() > kMaxTextLength) {
    throw JsonError(object.PathOf(key) + " must have 1 to 256 characters.");
  }
  return text;
}

void ReadParameters(const json& list, InstantAction* action) {
  if (!list.is_array() || list.size() > kMaxActions) {
    throw JsonError("actionParameters must be a list of 100 at most.");
  }
  for (const json& value : list) {
    JsonObject parameter(value, "actionParameters[]");
    action->parameters.emplace(ShortText(parameter, "key"), parameter.Value("value"));
  }
}

InstantAction ReadAction(const json& value, const std::string& path) {
  JsonObject object(value, path);
  InstantAction action;
  action.id = ShortText(object, "actionId");
  try {
    // The published schema of 2.1 says actionName where its text says actionType.
    action.type =
        ShortText(object, object.Has("actionType") || !object.Has("actionName") ? "actionType" : "actionName");
    if (object.Has("actionParameters")) {
      ReadParameters(object.Value("actionParameters"), &action);
    }
  } catch (const JsonError& error) {
    action.misfit = error.what();
  }
  return action;
}

const json& Parameter(const InstantAction& action, const std::string& key) {
  const auto found = action.parameters.find(key);
  if (found == action.parameters.end()) {
    throw JsonError(action.type + " needs the parameter " + key + ".");
  }
  return found->second;
}

double NumberOf(const InstantAction& action, const std::string& key, double limit) {
  const json& value = Parameter(action, key);
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(std::abs(number) <= limit)) {
    throw JsonError(action.type + ": the parameter " + key + " must be a number of at most " + std::to_string(limit) +
                    " in size.");
  }
  return number;
}

std::string TextOf(const InstantAction& action, const std::string& key, std::size_t max_length = kMaxTextLength) {
  const json& value = Parameter(action, key);
  if (!value.is_string() || value.get_ref<const std::string&>().empty() ||
      value.get_ref<const std::string&>().size() > max_length) {
    throw JsonError(action.type + ": the parameter " + key + " must be a text of 1 to " + std::to_string(max_length) +
                    " characters.");
  }
  return value.get<std::string>();
}

bool IsSha256(const std::string& text) {
  constexpr std::size_t kLength = 64;
  return text.size() == kLength && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

MapVersionName MapOf(const InstantAction& action) {
  MapVersionName map{TextOf(action, "mapId"), TextOf(action, "mapVersion")};
  if (!IsMapName(map.map)) {
    throw JsonError(action.type + ": mapId must be the name of a map: 1 to 64 letters, digits, - and _.");
  }
  if (!IsSha256(map.version)) {
    throw JsonError(action.type +
                    ": mapVersion must be the content version of the map, 64 hexadecimal digits, as "
                    "floorloc-mapbuilder info prints it.");
  }
  return map;
}

DownloadMap ReadDownload(const InstantAction& action) {
  constexpr std::size_t kMaxLink = 2048;
  DownloadMap download{MapOf(action), TextOf(action, "mapDownloadLink", kMaxLink), ""};
  if (action.parameters.contains("mapHash")) {
    std::string hash = TextOf(action, "mapHash");
    std::transform(hash.begin(), hash.end(), hash.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    for (const std::string_view prefix : {"sha256:", "sha-256:"}) {
      hash = hash.starts_with(prefix) ? hash.substr(prefix.size()) : hash;
    }
    if (!IsSha256(hash)) {
      throw JsonError("downloadMap: mapHash must be the SHA-256 of the file, 64 hexadecimal digits.");
    }
    download.sha256 = hash;
  }
  return download;
}

}  // namespace

std::vector<InstantAction> ParseInstantActions(const std::string& payload) {
  const json message = ParseJson(payload, kMaxPayloadBytes);
  JsonObject object(message, "");
  const json& list = object.Value("actions");
  if (!list.is_array() || list.size() > kMaxActions) {
    throw JsonError("actions must be a list of 100 at most.");
  }
  std::vector<InstantAction> actions;
  for (std::size_t i = 0; i < list.size(); ++i) {
    actions.push_back(ReadAction(list[i], "actions[" + std::to_string(i) + "]"));
  }
  return actions;
}

OrderSummary ParseOrder(const std::string& payload) {
  const json message = ParseJson(payload, kMaxPayloadBytes);
  JsonObject object(message, "");
  OrderSummary order;
  order.id = object.Text("orderId");
  const json& nodes = object.Value("nodes");
  if (!nodes.is_array()) {
    throw JsonError("nodes must be a list.");
  }
  for (const json& node : nodes) {
    JsonObject reader(node, "nodes[]");
    if (reader.Has("nodePosition")) {
      order.maps.insert(reader.Object("nodePosition").Text("mapId"));
    }
  }
  return order;
}

std::uint32_t ParseHeaderId(const std::string& payload) {
  const json message = ParseJson(payload, kMaxPayloadBytes);
  return static_cast<std::uint32_t>(
      JsonObject(message, "").Integer("headerId", 0, std::numeric_limits<std::uint32_t>::max()));
}

bool IsOfTheBridge(const std::string& type) {
  static const std::set<std::string> kTypes = {"initPosition", "initializePosition", "downloadMap", "enableMap",
                                               "deleteMap"};
  return kTypes.contains(type);
}

ActionCommand ParseCommand(const InstantAction& action) {
  if (action.type == "initPosition" || action.type == "initializePosition") {
    return InitPosition{NumberOf(action, "x", kMaxCoordinateM), NumberOf(action, "y", kMaxCoordinateM),
                        NumberOf(action, "theta", std::numbers::pi + kThetaTolerance), TextOf(action, "mapId")};
  }
  if (action.type == "downloadMap") {
    return ReadDownload(action);
  }
  if (action.type == "enableMap") {
    return EnableMap{MapOf(action)};
  }
  if (action.type == "deleteMap") {
    return DeleteMap{MapOf(action)};
  }
  if (action.type == "stateRequest") {
    return StateRequest{};
  }
  if (action.type == "clearInstantActions") {
    return ClearInstantActions{};
  }
  return OtherAction{};
}

}  // namespace floorloc
