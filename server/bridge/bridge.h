// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "clients/cpp/client.h"
#include "clients/cpp/events.h"
#include "server/bridge/bridge_config.h"
#include "server/bridge/job_queue.h"
#include "server/bridge/mqtt_connection.h"
#include "server/bridge/vehicle_bridge.h"

namespace floorloc {

struct BridgeSecrets {
  std::string server_token;
  std::string broker_password;
};

/// Vehicles of one floorloc-server on one MQTT broker. One thread, that of Run(), owns what is known of the vehicles;
/// the threads of the event stream, the broker's connections and the workers that call the server hand it jobs.
class Bridge {
 public:
  /// Throws std::invalid_argument and std::runtime_error with one sentence.
  Bridge(const BridgeConfig& config, const BridgeSecrets& secrets);
  ~Bridge();
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  /// Until Stop(); then says farewell to the broker.
  void Run();
  /// From any thread.
  void Stop();

 private:
  struct Line {
    std::unique_ptr<VehicleBridge> vehicle;
    std::unique_ptr<MqttConnection> connection;
  };

  Line MakeLine(const BridgedVehicle& vehicle, const std::string& password);
  bool RunTask(const ServerTask& task);
  void ListenToServer();
  void OnEvent(const client::Event& event);
  void Dispatch(const client::Event& event);
  void Refresh();
  void Apply(const std::vector<VehicleReport>& vehicles, const std::vector<MapEntry>& maps);
  void OnTime();
  double Now() const;
  template <typename Visit>
  void ForVehicle(const std::string& id, Visit visit);

  const BridgeConfig config_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::atomic<bool> stopping_{false};
  JobQueue inbox_;
  std::vector<Line> lines_;  // of the thread of Run()
  bool server_connected_ = false;
  bool refreshing_ = false;
  double next_refresh_s_ = 0.0;
  client::EventStream events_;
  client::Client quick_client_;  // of quick_
  client::Client slow_client_;   // of slow_
  std::unique_ptr<Worker> quick_;
  std::unique_ptr<Worker> slow_;
  std::thread listener_;
};

client::ClientOptions ServerOptions(const BridgeConfig& config, const BridgeSecrets& secrets);

}  // namespace floorloc
