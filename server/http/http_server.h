// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/http/http_handler.h"
#include "server/http/http_limits.h"

namespace floorloc {

struct HttpServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free port
  HttpLimits limits;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// HTTP/1.1 over TCP, one thread per connection. Limited are the connections (further ones are answered with 503),
/// the bytes of one body and of all bodies, and the time of a request. cpp-httplib parses the requests.
class HttpServer {
 public:
  /// Binds the address. Throws std::runtime_error when it cannot be used.
  HttpServer(const HttpServerOptions& options, HttpHandler& handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  int connections() const;

  /// Answers requests until Stop(); returns when the requests in flight are answered and every connection is closed.
  void Serve();
  /// Stops accepting. May be called from any thread, also before Serve().
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
