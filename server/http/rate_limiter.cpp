// SPDX-License-Identifier: Apache-2.0
#include "server/http/rate_limiter.h"

#include <algorithm>

namespace floorloc {
namespace {

constexpr std::size_t kMaxClients = 10'000;

}  // namespace

bool RateLimiter::Allow(const std::string& client, TimePoint now) {
  if (rate_per_s_ <= 0.0) {
    return true;
  }
  const std::lock_guard lock(mutex_);
  if (buckets_.size() >= kMaxClients) {
    DropFullBuckets(now);
  }
  const double burst = std::max(1.0, rate_per_s_);
  const auto [it, inserted] = buckets_.try_emplace(client, Bucket{burst, now});
  Bucket& bucket = it->second;
  const double elapsed_s = std::chrono::duration<double>(now - bucket.updated).count();
  bucket.tokens = std::min(burst, bucket.tokens + elapsed_s * rate_per_s_);
  bucket.updated = now;
  if (bucket.tokens < 1.0) {
    return false;
  }
  bucket.tokens -= 1.0;
  return true;
}

// A bucket is full again after max(1 s, 1/rate); then it is equivalent to a new one.
void RateLimiter::DropFullBuckets(TimePoint now) {
  const double full_after_s = std::max(1.0, 1.0 / rate_per_s_);
  std::erase_if(buckets_, [&](const auto& entry) {
    return std::chrono::duration<double>(now - entry.second.updated).count() > full_after_s;
  });
}

}  // namespace floorloc
