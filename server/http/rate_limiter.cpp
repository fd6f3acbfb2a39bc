// SPDX-License-Identifier: Apache-2.0
#include "server/http/rate_limiter.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxClients = 10'000;

}  // namespace

bool RateLimiter::Allow(const std::string& client, TimePoint now) {
  if (rate_per_s_ <= 0.0) {
    return true;
  }
  const std::lock_guard lock(mutex_);
  if (buckets_.size() >= kMaxClients && !buckets_.contains(client)) {
    DropFullBuckets(now);
  }
  Bucket& bucket = buckets_.try_emplace(client, Bucket{burst_, now}).first->second;
  bucket = {TokensOf(bucket, now), now};
  if (bucket.tokens < 1.0) {
    return false;
  }
  bucket.tokens -= 1.0;
  return true;
}

bool RateLimiter::WouldAllow(const std::string& client, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const auto it = buckets_.find(client);
  return rate_per_s_ <= 0.0 || it == buckets_.end() || TokensOf(it->second, now) >= 1.0;
}

double RateLimiter::TokensOf(const Bucket& bucket, TimePoint now) const {
  return std::min(burst_, bucket.tokens + std::chrono::duration<double>(now - bucket.updated).count() * rate_per_s_);
}

// A full bucket is equivalent to a new one.
void RateLimiter::DropFullBuckets(TimePoint now) {
  std::erase_if(buckets_, [&](const auto& entry) { return TokensOf(entry.second, now) >= burst_; });
}

}  // namespace floorloc
