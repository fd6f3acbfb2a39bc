// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/wire/http_message.h"
#include "server/wire/problem.h"

namespace floorloc {

/// What stands behind the HTTP server. Called from many threads; never throws.
class HttpHandler {
 public:
  virtual ~HttpHandler() = default;

  /// Looks at a request before its body is read. An answer refuses it, and the body stays unread.
  virtual std::optional<HttpResponse> Admit(const HttpRequest& head) = 0;
  /// Answers a whole request.
  virtual HttpResponse Handle(HttpRequest request) = 0;
  /// The answer to what the HTTP layer itself refuses (too large, malformed, ...).
  virtual HttpResponse Refuse(const HttpRequest& request, const Problem& problem) = 0;
};

}  // namespace floorloc
