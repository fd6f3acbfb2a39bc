// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/http/http_handler.h"
#include "server/http/http_limits.h"

namespace floorloc {

struct HttpServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free one
  HttpLimits limits;
};

/// HTTP/1.1 over TCP, one thread per connection, everything bounded: connections (the excess is answered with 503),
/// bytes of one body and of all bodies, time of a request. The only user of cpp-httplib, which parses the requests.
class HttpServer {
 public:
  /// Binds. Throws std::runtime_error when the address cannot be used.
  HttpServer(const HttpServerOptions& options, HttpHandler& handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  int connections() const;

  /// Answers requests until Stop(); returns when the requests in flight are answered and every connection is closed.
  void Serve();
  /// Stops accepting. From any thread, also before Serve().
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
