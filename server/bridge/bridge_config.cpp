// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/bridge_config.h"

#include <charconv>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

#include "server/wire/names.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxNameLength = 64;
const std::set<std::string> kOperatingModes = {"AUTOMATIC", "SEMIAUTOMATIC", "MANUAL", "SERVICE"};  // of both versions

void Require(bool right, const std::string& sentence) {
  if (!right) {
    throw std::invalid_argument(sentence);
  }
}

// A level of a topic: VDA 5050 (2.1, 6.1) allows these in serial numbers; a manufacturer has no wildcards either.
bool IsTopicLevel(const std::string& text, bool serial) {
  constexpr std::string_view kSerial = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.:-";
  const auto allowed = [&](char c) {
    return serial ? kSerial.find(c) != std::string_view::npos
                  : c > ' ' && c < 127 && c != '/' && c != '+' && c != '#' && c != '$';
  };
  return !text.empty() && text.size() <= kMaxNameLength && std::all_of(text.begin(), text.end(), allowed);
}

void ReadNumber(JsonObject& object, const std::string& key, double& value) {
  if (object.Has(key)) {
    value = object.Number(key);
  }
}

template <typename Text>
void ReadText(JsonObject& object, const std::string& key, Text& value) {
  if (object.Has(key)) {
    value = object.Text(key);
  }
}

template <typename Integer>
void ReadInteger(JsonObject& object, const std::string& key, std::int64_t max, Integer& value) {
  if (object.Has(key)) {
    value = static_cast<Integer>(object.Integer(key, 1, max));
  }
}

void ReadBroker(JsonObject object, BrokerOptions& broker) {
  ReadText(object, "host", broker.host);
  ReadInteger(object, "port", 65535, broker.port);
  ReadText(object, "username", broker.username);
  ReadText(object, "password_file", broker.password_file);
  ReadInteger(object, "keepalive_s", 3600, broker.keepalive_s);
  ReadNumber(object, "reconnect_min_s", broker.reconnect_min_s);
  ReadNumber(object, "reconnect_max_s", broker.reconnect_max_s);
  ReadInteger(object, "max_queued", 100'000, broker.max_queued);
  if (object.Has("tls")) {
    JsonObject tls = object.Object("tls");
    broker.tls = true;
    ReadText(tls, "ca_file", broker.ca_file);
    ReadText(tls, "certificate_file", broker.certificate_file);
    ReadText(tls, "key_file", broker.key_file);
    tls.RejectUnknownKeys();
  }
  object.RejectUnknownKeys();
}

BridgedVehicle ReadVehicle(const nlohmann::json& value, const std::string& path, bool own_state) {
  JsonObject object(value, path);
  BridgedVehicle vehicle{object.Text("id"), {object.Text("manufacturer"), ""}, own_state};
  vehicle.identity.serial_number = object.Has("serial") ? object.Text("serial") : vehicle.id;
  vehicle.own_state = object.Has("own_state") ? object.Bool("own_state") : own_state;
  object.RejectUnknownKeys();
  return vehicle;
}

const nlohmann::json& ListOf(JsonObject& object, const std::string& key) {
  const nlohmann::json& list = object.Value(key);
  if (!list.is_array()) {
    throw JsonError(object.PathOf(key) + " must be a list.");
  }
  return list;
}

void ReadDownloads(JsonObject object, DownloadOptions& downloads) {
  if (object.Has("from")) {
    for (const nlohmann::json& prefix : ListOf(object, "from")) {
      if (!prefix.is_string()) {
        throw JsonError("downloads.from must be a list of texts.");
      }
      downloads.from.push_back(prefix.get<std::string>());
    }
  }
  ReadInteger(object, "max_bytes", std::int64_t{1} << 40, downloads.max_bytes);
  ReadNumber(object, "timeout_s", downloads.timeout_s);
  object.RejectUnknownKeys();
}

void ReadBehaviour(JsonObject& object, BehaviourOptions& behaviour) {
  ReadNumber(object, "lost_after_s", behaviour.lost_after_s);
  ReadNumber(object, "confirm_within_s", behaviour.confirm_within_s);
  ReadNumber(object, "state_period_s", behaviour.state_period_s);
  ReadNumber(object, "error_hold_s", behaviour.error_hold_s);
  ReadNumber(object, "driving_above", behaviour.driving_above);
  ReadText(object, "operating_mode", behaviour.operating_mode);
  ReadNumber(object, "charge_percent", behaviour.charge_percent);
}

void CheckVehicles(const std::vector<BridgedVehicle>& vehicles) {
  Require(!vehicles.empty(), "no vehicle: give --vehicle and --manufacturer, or a list of vehicles with --config");
  std::set<std::string> ids;
  std::set<std::string> serials;
  for (const BridgedVehicle& vehicle : vehicles) {
    const std::string& manufacturer = vehicle.identity.manufacturer;
    const std::string& serial = vehicle.identity.serial_number;
    Require(IsVehicleId(vehicle.id),
            "the vehicle's id '" + vehicle.id + "' is none of floorloc-server: 1 to 64 letters, digits, and - _ .");
    Require(IsTopicLevel(manufacturer, false),
            "the manufacturer of vehicle '" + vehicle.id +
                "' must have 1 to 64 printable characters without spaces and / + # $");
    Require(IsTopicLevel(serial, true),
            "the serial number of vehicle '" + vehicle.id + "' must have 1 to 64 letters, digits, and _ . : -");
    Require(ids.insert(vehicle.id).second, "the vehicle '" + vehicle.id + "' is there twice");
    std::string both = manufacturer;
    both.append("/").append(serial);
    Require(serials.insert(both).second, "two vehicles have the manufacturer and serial number '" + both + "'");
  }
}

}  // namespace

void BridgeConfig::Check() const {
  Require(server_url.starts_with("http://") || server_url.starts_with("https://"),
          "server.url must be the address of a floorloc-server, such as http://localhost:8080");
  Require(!broker.host.empty(), "broker.host must be the name or the address of an MQTT broker");
  Require(broker.certificate_file.empty() == broker.key_file.empty(),
          "broker.tls.certificate_file and broker.tls.key_file come together");
  Require(broker.reconnect_min_s > 0.0 && broker.reconnect_max_s >= broker.reconnect_min_s,
          "broker.reconnect_min_s must be positive, and broker.reconnect_max_s not smaller");
  CheckVehicles(vehicles);
  Require(behaviour.lost_after_s >= 0.0, "lost_after_s must not be negative");
  Require(behaviour.confirm_within_s > 0.0, "confirm_within_s must be positive");
  Require(behaviour.state_period_s > 0.0 && behaviour.state_period_s <= 30.0,
          "state_period_s must be positive, and 30 at most (VDA 5050)");
  Require(behaviour.error_hold_s > 0.0, "error_hold_s must be positive");
  Require(behaviour.driving_above > 0.0, "driving_above must be positive");
  Require(kOperatingModes.contains(behaviour.operating_mode),
          "operating_mode must be AUTOMATIC, SEMIAUTOMATIC, MANUAL or SERVICE");
  Require(behaviour.charge_percent >= 0.0 && behaviour.charge_percent <= 100.0, "charge_percent must be 0 to 100");
  Require(downloads.timeout_s > 0.0 && downloads.timeout_s <= 86400.0, "downloads.timeout_s must be 0 to 86400");
  Require(log_level == "debug" || log_level == "info" || log_level == "warning" || log_level == "error",
          "log_level must be debug, info, warning or error");
}

VdaVersion ParseVdaVersion(const std::string& text) {
  Require(text == "2.1" || text == "3.0", "the version of VDA 5050 must be 2.1 or 3.0, not '" + text + "'");
  return text == "2.1" ? VdaVersion::kVersion2 : VdaVersion::kVersion3;
}

void SetBroker(const std::string& text, BrokerOptions* broker) {
  const std::string sentence = "the broker must be HOST, HOST:PORT or [IPv6]:PORT, not '" + text + "'";
  const bool bracket = text.starts_with('[');
  const std::size_t end = bracket ? text.find(']') : std::min(text.rfind(':'), text.size());
  Require(end != std::string::npos && end > (bracket ? 1U : 0U), sentence);
  broker->host = bracket ? text.substr(1, end - 1) : text.substr(0, end);
  const std::string rest = text.substr(bracket ? end + 1 : end);
  if (rest.empty()) {
    return;
  }
  const char* last = rest.data() + rest.size();
  const auto [parsed, error] = std::from_chars(rest.data() + 1, last, broker->port);
  Require(rest[0] == ':' && error == std::errc() && parsed == last && broker->port >= 1 && broker->port <= 65535,
          sentence);
}

BridgeConfig ParseBridgeConfig(const std::string& text) {
  const nlohmann::json json = ParseJson(text);
  JsonObject object(json, "");
  BridgeConfig config;
  if (object.Has("server")) {
    JsonObject server = object.Object("server");
    ReadText(server, "url", config.server_url);
    ReadText(server, "token_file", config.server_token_file);
    server.RejectUnknownKeys();
  }
  if (object.Has("broker")) {
    ReadBroker(object.Object("broker"), config.broker);
  }
  if (object.Has("vda5050")) {
    try {
      config.version = ParseVdaVersion(object.Text("vda5050"));
    } catch (const std::invalid_argument& error) {
      throw JsonError(std::string("vda5050: ") + error.what() + ".");
    }
  }
  const bool own_state = object.Has("own_state") && object.Bool("own_state");
  if (object.Has("vehicles")) {
    const nlohmann::json& list = ListOf(object, "vehicles");
    for (std::size_t i = 0; i < list.size(); ++i) {
      config.vehicles.push_back(ReadVehicle(list[i], "vehicles[" + std::to_string(i) + "]", own_state));
    }
  }
  ReadBehaviour(object, config.behaviour);
  if (object.Has("downloads")) {
    ReadDownloads(object.Object("downloads"), config.downloads);
  }
  ReadText(object, "log_level", config.log_level);
  object.RejectUnknownKeys();
  return config;
}

BridgeConfig ReadBridgeConfig(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) {
    throw std::runtime_error("the configuration " + file.string() + " cannot be read");
  }
  try {
    return ParseBridgeConfig(text.str());
  } catch (const JsonError& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

std::string ReadSecret(const std::filesystem::path& file, const char* variable) {
  if (file.empty()) {
    const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): at the start, nobody sets it
    return value == nullptr ? "" : value;
  }
  std::ifstream stream(file);
  std::string secret;
  if (!std::getline(stream, secret) || secret.empty()) {
    throw std::runtime_error("the file " + file.string() + " cannot be read, or its first line is empty");
  }
  std::error_code error;
  const auto permissions = std::filesystem::status(file, error).permissions();
  if (!error && (permissions & std::filesystem::perms::others_read) != std::filesystem::perms::none) {
    throw std::runtime_error("the file " + file.string() + " is a secret that everybody can read: chmod o-r it");
  }
  return secret;
}

}  // namespace floorloc
