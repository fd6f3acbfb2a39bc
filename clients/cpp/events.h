// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cpp/client.h"

namespace floorloc::client {

/// Something that happened, of GET /v1/events; `gap`: events were lost, ask ListVehicles and ListMaps.
struct Event {
  std::string type;
  std::string id;       ///< another connection goes on after it
  nlohmann::json data;  ///< null: none
};

/// Bytes of a stream of server-sent events (WHATWG HTML, 9.2) to events; they may be cut anywhere.
class EventParser {
 public:
  /// The events that these bytes complete. Throws CallError for data that is no JSON, and for an event that does not
  /// end.
  std::vector<Event> Push(std::string_view bytes);

 private:
  void TakeLine(std::string_view line, std::vector<Event>* events);

  std::string line_;
  std::string type_;
  std::string id_;
  std::string data_;
  bool after_return_ = false;
};

struct EventOptions {
  std::string map;                 ///< only events of it; empty: of all, as below
  std::string vehicle;             ///< only events of it
  std::vector<std::string> types;  ///< only these
  std::string last_event_id;       ///< only those after it
  /// The wait before the first attempt to connect again; doubled with each, up to the next.
  std::chrono::milliseconds first_wait{100};
  std::chrono::milliseconds max_wait{5000};
  std::chrono::milliseconds patience{60'000};  ///< so long without a connection is an error; zero: none is
  std::chrono::milliseconds silence{45'000};   ///< of a broken connection; the server says something every 15 s

  /// Throws std::invalid_argument that names the field.
  void Check() const;
};

/// Events as they happen, on a connection of its own, which is opened again when it breaks.
class EventStream {
 public:
  struct Handler {
    std::function<void(const Event&)> on_event;
    /// The connection was opened, or is lost; may be empty.
    std::function<void(bool connected)> on_connection = {};
  };

  /// Throws std::invalid_argument.
  EventStream(ClientOptions client, EventOptions options);
  ~EventStream();
  EventStream(const EventStream&) = delete;
  EventStream& operator=(const EventStream&) = delete;

  /// Calls the handler, in this thread, until Stop() is called. Throws CallError when the server refuses, and when
  /// there was no connection for EventOptions::patience.
  void Run(const Handler& handler);
  /// From any thread, once and for all.
  void Stop();

 private:
  class Connection;
  class Reception;

  void Listen(const Handler& handler);
  void WaitBeforeRetry(std::chrono::milliseconds wait) const;

  ClientOptions client_;
  EventOptions options_;
  std::unique_ptr<Connection> connection_;
  std::atomic<bool> stopping_{false};
  std::chrono::steady_clock::time_point last_contact_;
};

}  // namespace floorloc::client
