// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string>
#include <unordered_map>

#include "server/http/rate_limiter.h"

namespace floorloc {

/// Slows down those who guess tokens. Thread-safe.
class LoginLimiter {
 public:
  using TimePoint = RateLimiter::TimePoint;
  enum class Verdict { kAllowed, kRefused, kLocked };

  /// max_failures: per client address and minute; 0: no limit.
  explicit LoginLimiter(int max_failures) : failures_(max_failures / 60.0, max_failures) {}

  /// Once an address has failed too often, it is locked for some seconds: a right token is no more told from a wrong
  /// one. A client that logged in from there within the last hour goes on, so that one vehicle with a wrong token does
  /// not stop a fleet behind one address.
  Verdict Judge(const std::string& client, bool token_is_right, TimePoint now);

 private:
  bool HasLoggedIn(const std::string& client, TimePoint now);

  RateLimiter failures_;
  std::mutex mutex_;
  std::unordered_map<std::string, TimePoint> last_logins_;
};

}  // namespace floorloc
