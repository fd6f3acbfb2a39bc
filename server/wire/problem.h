// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "server/wire/http_message.h"

namespace floorloc {

/// An error for the client, answered as RFC 9457 application/problem+json.
class Problem : public std::runtime_error {
 public:
  enum class Retry { kNo, kSoon };

  /// code: stable, for programs. detail: one sentence for people that says what to do. kSoon: the same request may
  /// succeed in a moment.
  Problem(int status, std::string code, const std::string& detail, Retry retry = Retry::kNo)
      : std::runtime_error(detail), status_(status), code_(std::move(code)), retry_(retry) {}

  int status() const { return status_; }
  const std::string& code() const { return code_; }
  Retry retry() const { return retry_; }
  /// For Retry::kSoon: after how many seconds.
  int retry_after_s() const { return retry_after_s_; }

 protected:
  void SetRetryAfter(int seconds) { retry_after_s_ = seconds; }

 private:
  int status_;
  std::string code_;
  Retry retry_;
  int retry_after_s_ = 1;
};

/// The server is overloaded: 503 with Retry-After.
class Overload : public Problem {
 public:
  Overload(std::string code, const std::string& detail, int retry_after_s = 1)
      : Problem(503, std::move(code), detail, Retry::kSoon) {
    SetRetryAfter(retry_after_s);
  }
};

/// The problem+json response, with Retry-After for Retry::kSoon and WWW-Authenticate for 401.
HttpResponse ToResponse(const Problem& problem);

/// The problem for a status that the HTTP library generates (malformed request line, ...).
Problem ProblemOfStatus(int status);

}  // namespace floorloc
