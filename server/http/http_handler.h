// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/wire/http_message.h"
#include "server/wire/problem.h"

namespace floorloc {

/// Handler of the HTTP server's requests. Called from many threads; but for OpenBody, nothing throws.
class HttpHandler {
 public:
  virtual ~HttpHandler() = default;

  /// Called before the body of a request is read. A response rejects it, and the body stays unread.
  virtual std::optional<HttpResponse> Admit(const HttpRequest& head) = 0;
  /// Is this the call of a health check? It is answered when all connections are taken.
  virtual bool IsHealthCheck(const HttpRequest& head) const = 0;
  /// Where the body of an admitted request goes while it is read; empty: into memory. Throws Problem to refuse it.
  virtual std::optional<BodyStream> OpenBody(const HttpRequest& /*head*/) { return std::nullopt; }
  /// Answers a complete request.
  virtual HttpResponse Handle(HttpRequest request) = 0;
  /// The response to what the HTTP layer itself rejects (too large, malformed, ...).
  virtual HttpResponse Refuse(const HttpRequest& request, const Problem& problem) = 0;
};

}  // namespace floorloc
