// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace floorloc {

/// Limits of connections and requests, independent of the route.
struct HttpLimits {
  std::size_t max_body_bytes = std::size_t{16} << 20;
  std::size_t max_bodies_bytes = std::size_t{256} << 20;  ///< of all requests that are being read or answered
  int max_connections = 1024;
  double idle_timeout_s = 60.0;     ///< of a keep-alive connection
  double request_timeout_s = 30.0;  ///< to send a request, and again to receive its response

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

}  // namespace floorloc
