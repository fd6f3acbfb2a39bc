// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/bridge/protocol.h"

namespace floorloc {

struct BrokerOptions {
  std::string host = "localhost";
  int port = 0;  ///< 0: 1883, with TLS 8883
  std::string username;
  std::filesystem::path password_file;  ///< empty: the environment variable FLOORLOC_MQTT_PASSWORD, if it is set
  bool tls = false;
  std::filesystem::path ca_file;           ///< of the broker's authority; empty with TLS: those of the system
  std::filesystem::path certificate_file;  ///< of this client; both or none
  std::filesystem::path key_file;
  int keepalive_s = 15;  ///< VDA 5050 (6.1) wants 15 s
  double reconnect_min_s = 1.0;
  double reconnect_max_s = 30.0;  ///< waits double up to it
  int max_queued = 200;           ///< messages that the network has not taken; positions beyond are dropped

  int Port() const { return port != 0 ? port : tls ? 8883 : 1883; }
};

struct BridgedVehicle {
  std::string id;  ///< of floorloc-server
  VehicleIdentity identity;
  bool own_state = false;  ///< the bridge publishes the vehicle's state: it has no client of its own
};

struct DownloadOptions {
  std::vector<std::string> from;  ///< links must begin with one of these; empty: any http or https link
  std::uint64_t max_bytes = std::uint64_t{8} << 30;  ///< as limits.max_map_bytes of the server
  double timeout_s = 600.0;                          ///< of a download, and of the upload to the server
};

/// Of one vehicle's messages, the same for all.
struct BehaviourOptions {
  double lost_after_s = 1.0;              ///< LOCALIZATION_ERROR begins and ends when its cause did for so long
  double confirm_within_s = 30;           ///< an initial pose that no image confirms or contradicts by then has failed
  double state_period_s = 1.0;            ///< own state: at least so often; VDA 5050 wants 30 s
  double error_hold_s = 60.0;             ///< how long the error of a failed action or a malformed message is told
  double driving_above = 0.02;            ///< own state: driving above this speed, m/s or rad/s
  std::string operating_mode = "MANUAL";  ///< own state: orders are not taken
  double charge_percent = 100.0;          ///< own state: the server does not know it
};

struct BridgeConfig {
  std::string server_url = "http://127.0.0.1:8080";
  std::filesystem::path server_token_file;  ///< empty: the environment variable FLOORLOC_TOKEN, if it is set
  BrokerOptions broker;
  VdaVersion version = VdaVersion::kVersion2;
  std::vector<BridgedVehicle> vehicles;
  BehaviourOptions behaviour;
  DownloadOptions downloads;
  std::string log_level = "info";

  /// Throws std::invalid_argument that names the key and what it may be.
  void Check() const;
};

/// Throws JsonError with one sentence that names the key.
BridgeConfig ParseBridgeConfig(const std::string& text);

/// Throws std::runtime_error that names the file and the key.
BridgeConfig ReadBridgeConfig(const std::filesystem::path& file);

/// "2.1" or "3.0". Throws std::invalid_argument.
VdaVersion ParseVdaVersion(const std::string& text);

/// "HOST", "HOST:PORT" or "[IPv6]:PORT". Throws std::invalid_argument.
void SetBroker(const std::string& text, BrokerOptions* broker);

/// The first line of the file or, without one, the environment variable; empty: neither. Throws std::runtime_error when
/// the file cannot be read, is empty, or is open to all.
std::string ReadSecret(const std::filesystem::path& file, const char* variable);

}  // namespace floorloc
