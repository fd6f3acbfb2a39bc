// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/retry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace floorloc::client {
namespace {

using std::chrono::milliseconds;

Failure Refused(int status, const std::string& reason, std::optional<milliseconds> retry_after) {
  return {status, reason, "", retry_after, ""};
}

class RetryTest : public testing::Test {
 protected:
  std::optional<milliseconds> Wait(const Failure& failure, int attempt = 1) {
    return WaitBeforeRetry(options_, failure, attempt, random_);
  }

  RetryOptions options_;
  std::mt19937_64 random_{1};
};

TEST_F(RetryTest, WaitsAsTheServerSaysAndUpToAQuarterMore) {
  for (int i = 0; i < 100; ++i) {
    const auto wait = Wait(Refused(429, "rate_limited", milliseconds(2000)));
    ASSERT_TRUE(wait.has_value());
    EXPECT_GE(*wait, milliseconds(2000));
    EXPECT_LE(*wait, milliseconds(2500));
  }
}

TEST_F(RetryTest, WaitsDoubleWithoutAWordOfTheServer) {
  options_.attempts = 10;
  for (const int attempt : {1, 2, 3, 8}) {
    milliseconds longest{0};
    for (int i = 0; i < 100; ++i) {
      longest = std::max(longest, Wait(Refused(0, kUnreachable, std::nullopt), attempt).value());
    }
    const milliseconds bound = std::min(options_.max_wait, milliseconds(100 << (attempt - 1)));
    EXPECT_LE(longest, bound);
    EXPECT_GT(longest, bound * 9 / 10) << "all of the time is used";
  }
}

TEST_F(RetryTest, GivesUpWhatWouldNotChangeOrTakesTooLong) {
  EXPECT_FALSE(Wait(Refused(503, "queue_full", milliseconds(1000)), options_.attempts));
  EXPECT_FALSE(Wait(Refused(503, "draining", milliseconds(60'000))));
  EXPECT_FALSE(Wait(Refused(503, "replaced", milliseconds(1000))));
  EXPECT_FALSE(Wait(Refused(503, "no_maps", std::nullopt)));
  EXPECT_FALSE(Wait(Refused(404, "unknown_map", std::nullopt)));
  EXPECT_FALSE(Wait(Refused(0, kDeadlineExceeded, std::nullopt)));
}

TEST(ParseRetryAfterTest, TakesWholeSeconds) {
  EXPECT_EQ(ParseRetryAfter("7"), milliseconds(7000));
  for (const char* text : {"", "soon", "-1", "1.5", "7 s"}) {
    EXPECT_FALSE(ParseRetryAfter(text)) << text;
  }
}

TEST(RetryOptionsTest, NamesWhatIsWrong) {
  RetryOptions options;
  EXPECT_NO_THROW(options.Check());
  options.attempts = 0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc::client
