// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <unordered_map>

namespace floorloc {

/// One token bucket per client address: rate_per_s requests per second, bursts of one second (at least one request).
class RateLimiter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// rate_per_s 0: no limit.
  explicit RateLimiter(double rate_per_s) : rate_per_s_(rate_per_s) {}

  /// Takes a token. False when the rate limit is exceeded.
  bool Allow(const std::string& client, TimePoint now);

 private:
  struct Bucket {
    double tokens = 0.0;
    TimePoint updated;
  };

  void DropFullBuckets(TimePoint now);

  const double rate_per_s_;
  std::mutex mutex_;
  std::unordered_map<std::string, Bucket> buckets_;
};

}  // namespace floorloc
