// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <random>
#include <string>

#include "clients/cpp/call_error.h"

namespace floorloc::client {

/// Calls that were refused with 429 or 503, or got no answer, are tried again, within the call's deadline.
struct RetryOptions {
  int attempts = 3;  ///< in all; 1: never again
  /// Without a Retry-After; doubled each time, of which a random share is waited.
  std::chrono::milliseconds first_wait{100};
  std::chrono::milliseconds max_wait{5000};  ///< when the server wants more the call fails at once
  double jitter = 0.25;  ///< of a Retry-After, waited on top at most: a fleet should not come back all at once
  std::uint64_t seed = std::random_device{}();  ///< of the shares: other ones in each process

  /// Throws std::invalid_argument that names the field.
  void Check() const;
};

/// How long to wait after this attempt, the first is 1, before the next; nothing: there is none.
std::optional<std::chrono::milliseconds> WaitBeforeRetry(const RetryOptions& options, const Failure& failure,
                                                         int attempt, std::mt19937_64& random);

/// Of a Retry-After (RFC 9110, 10.2.3) in seconds; nothing when it is no number.
std::optional<std::chrono::milliseconds> ParseRetryAfter(const std::string& text);

}  // namespace floorloc::client
