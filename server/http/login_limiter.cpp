// SPDX-License-Identifier: Apache-2.0
#include "server/http/login_limiter.h"

namespace floorloc {
namespace {

constexpr std::chrono::hours kRemembered{1};
constexpr std::size_t kMaxClients = 10'000;

}  // namespace

LoginLimiter::Verdict LoginLimiter::Judge(const std::string& client, bool token_is_right, TimePoint now) {
  if (!token_is_right) {
    return failures_.Allow(client, now) ? Verdict::kRefused : Verdict::kLocked;
  }
  if (!failures_.WouldAllow(client, now) && !HasLoggedIn(client, now)) {
    return Verdict::kLocked;
  }
  const std::lock_guard lock(mutex_);
  if (last_logins_.size() >= kMaxClients) {
    std::erase_if(last_logins_, [now](const auto& entry) { return now - entry.second > kRemembered; });
  }
  if (last_logins_.size() < kMaxClients || last_logins_.contains(client)) {
    last_logins_[client] = now;
  }
  return Verdict::kAllowed;
}

bool LoginLimiter::HasLoggedIn(const std::string& client, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const auto it = last_logins_.find(client);
  return it != last_logins_.end() && now - it->second <= kRemembered;
}

}  // namespace floorloc
