// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

namespace floorloc::client {

/// A call that did not succeed.
struct Failure {
  int status = 0;      ///< of HTTP; 0: there was no answer
  std::string reason;  ///< for programs: the code of the server's problem, or one of those below
  std::string detail;  ///< one sentence for people, of the server when it answered
  std::optional<std::chrono::milliseconds> retry_after;  ///< when the same call may succeed, if the server said so
  std::string request_id;                                ///< under which the server's log has the request
};

inline constexpr const char* kUnreachable = "unreachable";             ///< no connection, or it broke
inline constexpr const char* kDeadlineExceeded = "deadline_exceeded";  ///< the call took longer than it might
inline constexpr const char* kMalformedAnswer = "malformed_answer";    ///< not that of a floorloc-server

/// The one exception of the calls.
class CallError : public std::runtime_error {
 public:
  explicit CallError(Failure failure)
      : std::runtime_error((failure.status == 0 ? "" : std::to_string(failure.status) + " ") + failure.reason + ": " +
                           failure.detail),
        failure_(std::move(failure)) {}

  const Failure& failure() const { return failure_; }
  int status() const { return failure_.status; }
  const std::string& reason() const { return failure_.reason; }

 private:
  Failure failure_;
};

}  // namespace floorloc::client
