// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "server/wire/http_message.h"

namespace floorloc {

/// An error for the client, answered as RFC 9457 application/problem+json.
class Problem : public std::runtime_error {
 public:
  /// code: stable and for machines; detail: one sentence for people that says what to do.
  Problem(int status, std::string code, const std::string& detail)
      : std::runtime_error(detail), status_(status), code_(std::move(code)) {}

  int status() const { return status_; }
  const std::string& code() const { return code_; }

 private:
  int status_;
  std::string code_;
};

/// The server cannot take more work now: 503 with Retry-After.
class Overload : public Problem {
 public:
  Overload(std::string code, const std::string& detail) : Problem(503, std::move(code), detail) {}
};

/// The problem+json answer. 429 and 503 carry Retry-After, 401 WWW-Authenticate.
HttpResponse ToResponse(const Problem& problem);

/// The problem for a status that the HTTP library answers by itself (malformed request line, ...).
Problem ProblemOfStatus(int status);

}  // namespace floorloc
