// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <string>
#include <vector>

namespace floorloc {

/// A request whose bytes are a head and a body that several requests may share.
struct PlannedRequest {
  std::string head;                   ///< with the empty line
  const std::string* body = nullptr;  ///< of LoadPlan::bodies; null: none
};

/// One connection of a client.
struct PlannedConnection {
  in_addr source{};                      ///< address that the connection comes from
  std::vector<PlannedRequest> requests;  ///< in this order
};

/// Clients that are reported together.
struct ClientGroup {
  std::string name;
  /// Of each connection, seconds between two requests, whatever the server does; 0: each request follows the answer to
  /// the one before (closed loop).
  double interval_s = 0.0;
  bool repeat = false;  ///< begin anew after the last request
  std::vector<PlannedConnection> connections;
};

/// What a load generator does. Not copyable: requests point to bodies.
struct LoadPlan {
  sockaddr_in server{};
  double seconds = 10.0;
  std::vector<std::string> bodies;
  std::vector<ClientGroup> groups;

  LoadPlan() = default;
  LoadPlan(const LoadPlan&) = delete;
  LoadPlan& operator=(const LoadPlan&) = delete;
};

/// Reads a plan from JSON:
///   {"port": 8080, "seconds": 10, "bodies": ["FILE", ...],
///    "groups": [{"name", "interval_s", "repeat",
///                "connections": [{"source": "127.0.0.2", "requests": [{"head": "POST ...", "body": 0}, ...]}]}]}
/// Heads get Host and Content-Length; "text" in the place of "body" is the body itself. Throws std::runtime_error.
void ReadLoadPlan(const std::string& json, LoadPlan* plan);

}  // namespace floorloc
