// SPDX-License-Identifier: Apache-2.0
#include "server/http/rate_limiter.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

TEST(RateLimiterTest, RefillsWithTime) {
  RateLimiter limiter(2.0);
  const RateLimiter::TimePoint start{};
  EXPECT_TRUE(limiter.Allow("a", start));
  EXPECT_TRUE(limiter.Allow("a", start));
  EXPECT_FALSE(limiter.Allow("a", start));
  EXPECT_TRUE(limiter.Allow("b", start));
  EXPECT_TRUE(limiter.Allow("a", start + std::chrono::milliseconds(500)));
  EXPECT_FALSE(limiter.Allow("a", start + std::chrono::milliseconds(501)));
  RateLimiter unlimited(0.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(unlimited.Allow("a", start));
  }
}

}  // namespace
}  // namespace floorloc
