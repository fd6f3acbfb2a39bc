// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/mqtt_connection.h"

#include <mosquitto.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <stdexcept>

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLoopMs = 100;
constexpr auto kFarewell = std::chrono::seconds(2);

void Require(int result, const std::string& what) {
  if (result != MOSQ_ERR_SUCCESS) {
    throw std::runtime_error(what + ": " + mosquitto_strerror(result));
  }
}

const char* TextOrNull(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

void StartTls(mosquitto* handle, const BrokerOptions& options) {
  const char* folder = options.ca_file.empty() ? "/etc/ssl/certs" : nullptr;
  Require(
      mosquitto_tls_set(handle, TextOrNull(options.ca_file.string()), folder,
                        TextOrNull(options.certificate_file.string()), TextOrNull(options.key_file.string()), nullptr),
      "the files of broker.tls cannot be used");
}

}  // namespace

void MqttConnection::Free::operator()(mosquitto* handle) const { mosquitto_destroy(handle); }

MqttConnection::MqttConnection(const BrokerOptions& options, const std::string& password, const std::string& client_id,
                               std::vector<std::string> subscriptions, MqttHandlers handlers)
    : options_(options), subscriptions_(std::move(subscriptions)), handlers_(std::move(handlers)), name_(client_id) {
  static std::once_flag once;
  std::call_once(once, [] { mosquitto_lib_init(); });
  handle_.reset(mosquitto_new(client_id.c_str(), true, this));
  if (!handle_) {
    throw std::runtime_error("there is no memory for a connection to the broker");
  }
  Require(mosquitto_threaded_set(handle_.get(), true), "the MQTT library");
  if (!options.username.empty()) {
    Require(mosquitto_username_pw_set(handle_.get(), options.username.c_str(), TextOrNull(password)),
            "broker.username cannot be used");
  }
  if (options.tls) {
    StartTls(handle_.get(), options);
  }
  mosquitto_connect_callback_set(handle_.get(), OnConnect);
  mosquitto_disconnect_callback_set(handle_.get(), OnDisconnect);
  mosquitto_message_callback_set(handle_.get(), OnMessage);
  mosquitto_publish_callback_set(handle_.get(), OnPublish);
}

MqttConnection::~MqttConnection() {
  stopping_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void MqttConnection::Start() {
  thread_ = std::thread([this] { Run(); });
}

int MqttConnection::Connect(bool again) {
  const OutgoingMessage will = handlers_.last_will();
  mosquitto_will_clear(handle_.get());
  if (!will.topic.empty()) {
    mosquitto_will_set(handle_.get(), will.topic.c_str(), static_cast<int>(will.payload.size()), will.payload.data(),
                       will.qos, will.retain);
  }
  return again ? mosquitto_reconnect_async(handle_.get())
               : mosquitto_connect_async(handle_.get(), options_.host.c_str(), options_.Port(), options_.keepalive_s);
}

void MqttConnection::Run() {
  bool again = false;
  double wait_s = options_.reconnect_min_s;
  std::string told;
  while (!stopping_) {
    int result = Connect(again);
    again = again || result == MOSQ_ERR_SUCCESS || result == MOSQ_ERR_ERRNO || result == MOSQ_ERR_EAI;
    bool was_connected = false;
    while (result == MOSQ_ERR_SUCCESS && !stopping_) {
      result = mosquitto_loop(handle_.get(), kLoopMs, 1);
      was_connected = was_connected || connected_;
    }
    connected_ = false;
    queued_ = 0;
    if (stopping_) {
      return;
    }
    const std::string trouble = mosquitto_strerror(result);
    wait_s = was_connected ? options_.reconnect_min_s : wait_s;
    if (was_connected || trouble != told) {  // not the same line for a broker that is away all night
      spdlog::warn("{}: no connection to the broker {}:{} ({}); it is tried again", name_, options_.host,
                   options_.Port(), trouble);
      told = trouble;
    }
    Wait(wait_s);
    wait_s = std::min(2.0 * wait_s, options_.reconnect_max_s);
  }
}

void MqttConnection::Wait(double seconds) const {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!stopping_ && Clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kLoopMs));
  }
}

bool MqttConnection::Publish(const OutgoingMessage& message) {
  if (!connected_ || (message.qos == 0 && queued_ >= options_.max_queued)) {
    return false;
  }
  ++queued_;
  const int result =
      mosquitto_publish(handle_.get(), nullptr, message.topic.c_str(), static_cast<int>(message.payload.size()),
                        message.payload.data(), message.qos, message.retain);
  if (result != MOSQ_ERR_SUCCESS) {
    --queued_;
  }
  return result == MOSQ_ERR_SUCCESS;
}

void MqttConnection::Close(const OutgoingMessage& last_message) {
  const auto end = Clock::now() + kFarewell;
  if (Publish(last_message)) {
    while (queued_ > 0 && connected_ && Clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    mosquitto_disconnect(handle_.get());  // or the broker would publish the last will
    while (connected_ && Clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  stopping_ = true;
}

void MqttConnection::OnConnect(mosquitto* handle, void* self, int result) {
  auto& connection = *static_cast<MqttConnection*>(self);
  if (result != 0) {
    spdlog::warn("{}: the broker refuses the connection: {}", connection.name_, mosquitto_connack_string(result));
    return;
  }
  for (const std::string& topic : connection.subscriptions_) {
    mosquitto_subscribe(handle, nullptr, topic.c_str(), 1);
  }
  connection.connected_ = true;
  spdlog::info("{}: connected to the broker {}:{}", connection.name_, connection.options_.host,
               connection.options_.Port());
  connection.handlers_.on_connected();
}

void MqttConnection::OnDisconnect(mosquitto* /*handle*/, void* self, int /*result*/) {
  static_cast<MqttConnection*>(self)->connected_ = false;
}

void MqttConnection::OnMessage(mosquitto* /*handle*/, void* self, const mosquitto_message* message) {
  const auto& connection = *static_cast<MqttConnection*>(self);
  const auto size = static_cast<std::size_t>(std::max(message->payloadlen, 0));
  connection.handlers_.on_message(message->topic, {static_cast<const char*>(message->payload), size});
}

void MqttConnection::OnPublish(mosquitto* /*handle*/, void* self, int /*id*/) {
  auto& queued = static_cast<MqttConnection*>(self)->queued_;
  queued = std::max(queued - 1, 0);
}

}  // namespace floorloc
