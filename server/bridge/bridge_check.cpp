// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/bridge_check.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ostream>
#include <thread>

#include "server/bridge/bridge.h"
#include "server/bridge/server_reports.h"

namespace floorloc {
namespace {

constexpr auto kBrokerTime = std::chrono::seconds(5);

class Findings {
 public:
  explicit Findings(std::ostream& out) : out_(out) {}
  void Ok(const std::string& what) { out_ << "ok      " << what << '\n'; }
  void Failed(const std::string& what) {
    out_ << "FAILED  " << what << '\n';
    failed_ = true;
  }
  bool failed() const { return failed_; }

 private:
  std::ostream& out_;
  bool failed_ = false;
};

void CheckServer(const BridgeConfig& config, const BridgeSecrets& secrets, Findings& findings) {
  client::Client client(ServerOptions(config, secrets));
  const std::vector<VehicleReport> known = ParseVehicleList(client.ListVehicles());
  const std::vector<MapEntry> maps = ListMapEntries(client);
  const auto ready = std::count_if(maps.begin(), maps.end(), [](const MapEntry& map) { return map.enabled; });
  findings.Ok("server: " + config.server_url + " has " + std::to_string(ready) + " maps");
  for (const BridgedVehicle& vehicle : config.vehicles) {
    const bool registered = std::any_of(known.begin(), known.end(),
                                        [&](const VehicleReport& one) { return one.pose.vehicle == vehicle.id; });
    if (registered) {
      findings.Ok("vehicle: " + vehicle.id + " is registered");
    } else {
      findings.Failed("vehicle: " + vehicle.id + " is not registered at the server: PUT /v1/vehicles/" + vehicle.id);
    }
  }
}

void CheckBroker(const BridgeConfig& config, const BridgeSecrets& secrets, Findings& findings) {
  std::atomic<bool> connected{false};
  // With a name of its own: a broker ends an older connection of the same name.
  MqttConnection connection(
      config.broker, secrets.broker_password, "floorloc-bridge-check", {},
      {[] { return OutgoingMessage{}; }, [&] { connected = true; }, [](const std::string&, const std::string&) {}});
  connection.Start();
  const auto end = std::chrono::steady_clock::now() + kBrokerTime;
  while (!connected && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const std::string broker = "broker: " + config.broker.host + ":" + std::to_string(config.broker.Port());
  if (connected) {
    findings.Ok(broker + " takes connections");
  } else {
    findings.Failed(broker + " takes no connection within 5 s");
  }
}

}  // namespace

int CheckBridge(const BridgeConfig& config, std::ostream& out) {
  Findings findings(out);
  const auto check = [&](const std::string& what, const auto& run) {
    try {
      run();
    } catch (const std::exception& error) {
      findings.Failed(what + ": " + error.what());
    }
  };
  BridgeSecrets secrets;
  check("configuration", [&] {
    config.Check();
    secrets = {ReadSecret(config.server_token_file, "FLOORLOC_TOKEN"),
               ReadSecret(config.broker.password_file, "FLOORLOC_MQTT_PASSWORD")};
    findings.Ok("configuration: " + std::to_string(config.vehicles.size()) + " vehicles");
  });
  if (findings.failed()) {
    return 1;
  }
  check("server", [&] { CheckServer(config, secrets, findings); });
  check("broker", [&] { CheckBroker(config, secrets, findings); });
  return findings.failed() ? 1 : 0;
}

}  // namespace floorloc
