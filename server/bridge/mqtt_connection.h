// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/bridge/bridge_config.h"
#include "server/bridge/vehicle_bridge.h"

struct mosquitto;
struct mosquitto_message;

namespace floorloc {

struct MqttHandlers {
  std::function<OutgoingMessage()> last_will;  ///< before each attempt to connect; without a topic: none
  std::function<void()> on_connected;          ///< the subscriptions are made
  std::function<void(const std::string& topic, std::string payload)> on_message;
};

/// A connection of one vehicle to the broker, for its last will, in a thread of its own, which calls the handlers.
/// Connects again with waits that double. While it is not connected nothing is queued: on_connected is the time to say
/// what is.
class MqttConnection {
 public:
  /// Throws std::runtime_error with one sentence, for files of TLS that cannot be used, say.
  MqttConnection(const BrokerOptions& options, const std::string& password, const std::string& client_id,
                 std::vector<std::string> subscriptions, MqttHandlers handlers);
  /// Without a farewell, see Close().
  ~MqttConnection();
  MqttConnection(const MqttConnection&) = delete;
  MqttConnection& operator=(const MqttConnection&) = delete;

  void Start();
  /// From any thread. False when it was dropped: not connected, or too much is queued for what may be lost (QoS 0).
  bool Publish(const OutgoingMessage& message);
  /// Publishes a last message in good order, which takes two seconds at most.
  void Close(const OutgoingMessage& last_message);
  bool connected() const { return connected_; }

 private:
  struct Free {
    void operator()(mosquitto* handle) const;
  };

  void Run();
  int Connect(bool again);
  void Wait(double seconds) const;
  static void OnConnect(mosquitto* handle, void* self, int result);
  static void OnDisconnect(mosquitto* handle, void* self, int result);
  static void OnMessage(mosquitto* handle, void* self, const mosquitto_message* message);
  static void OnPublish(mosquitto* handle, void* self, int id);

  const BrokerOptions options_;
  const std::vector<std::string> subscriptions_;
  const MqttHandlers handlers_;
  const std::string name_;
  std::unique_ptr<mosquitto, Free> handle_;
  std::atomic<bool> connected_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<int> queued_{0};
  std::thread thread_;
};

}  // namespace floorloc
