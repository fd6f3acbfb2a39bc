// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <mutex>
#include <string>
#include <unordered_map>

namespace floorloc {

/// One token bucket per client address.
class RateLimiter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// Bursts of one second (at least one request). rate_per_s 0: no limit.
  explicit RateLimiter(double rate_per_s) : RateLimiter(rate_per_s, rate_per_s) {}
  /// burst: how many at once; at least 1.
  RateLimiter(double rate_per_s, double burst) : rate_per_s_(rate_per_s), burst_(std::max(1.0, burst)) {}

  /// Takes a token. False when the rate limit is exceeded.
  bool Allow(const std::string& client, TimePoint now);
  /// The same without taking one.
  bool WouldAllow(const std::string& client, TimePoint now);

 private:
  struct Bucket {
    double tokens = 0.0;
    TimePoint updated;
  };

  void DropFullBuckets(TimePoint now);
  double TokensOf(const Bucket& bucket, TimePoint now) const;

  const double rate_per_s_;
  const double burst_;
  std::mutex mutex_;
  std::unordered_map<std::string, Bucket> buckets_;
};

}  // namespace floorloc
