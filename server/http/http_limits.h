// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace floorloc {

/// Limits of connections and requests, independent of the route.
struct HttpLimits {
  std::size_t max_body_bytes = std::size_t{16} << 20;
  std::size_t max_bodies_bytes = std::size_t{256} << 20;  ///< of all requests that are being read or answered
  int max_connections = 1024;
  int max_connections_per_address = 512;  ///< half of all: one address alone never fills the server
  int reserved_connections = 16;          ///< beyond max_connections, for health checks, one per address
  double reserved_timeout_s = 2.0;        ///< of these, to send a request: a health check is one packet
  double idle_timeout_s = 60.0;           ///< of a keep-alive connection
  double request_timeout_s = 30.0;        ///< to send a request, and again to receive its response
  double stop_timeout_s = 1.0;            ///< the same once the server stops: no client delays that for long

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

}  // namespace floorloc
