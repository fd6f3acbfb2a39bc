// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "server/fix_history.h"
#include "server/metrics.h"
#include "server/names.h"
#include "server/rate_limiter.h"
#include "server/router.h"

namespace floorloc {
namespace {

using Parameters = std::map<std::string, std::string>;

TEST(MatchPatternTest, TakesSegmentsByName) {
  EXPECT_EQ(MatchPattern("/v1/maps", "/v1/maps"), Parameters());
  EXPECT_EQ(MatchPattern("/a/{x}/b/{y}.jpg", "/a/1/b/-2.jpg"), (Parameters{{"x", "1"}, {"y", "-2"}}));
  EXPECT_EQ(MatchPattern("/", "/"), Parameters());
}

TEST(MatchPatternTest, RefusesEverythingElse) {
  for (const char* path :
       {"", "a", "/a", "/a/", "/a/1/b/.jpg", "/a/1/b/2.png", "/a/1/b/2.jpg/", "/a//b/2.jpg", "/b/1/b/2.jpg"}) {
    EXPECT_EQ(MatchPattern("/a/{x}/b/{y}.jpg", path), std::nullopt) << path;
  }
}

TEST(NamesTest, AreSafeInUrlsAndFileNames) {
  EXPECT_TRUE(IsMapName("Hall_2-b"));
  EXPECT_TRUE(IsVehicleId("agv.7"));
  for (const char* wrong : {"", "a/b", "a b", "..%2f", "\xC3\xA4"}) {
    EXPECT_FALSE(IsMapName(wrong)) << wrong;
    EXPECT_FALSE(IsVehicleId(wrong)) << wrong;
  }
  EXPECT_FALSE(IsMapName("a.b"));
  EXPECT_FALSE(IsMapName(std::string(65, 'a')));
  EXPECT_TRUE(IsMapName(std::string(64, 'a')));
}

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

TEST(FixHistoryTest, KeepsTheLastOfEveryMap) {
  FixHistory history(2);
  for (const char* map : {"a", "b", "a", "a"}) {
    FixRecord record;
    record.map = map;
    history.Add(record);
  }
  const auto all = history.Since("a", 0);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].sequence, 3U);
  EXPECT_EQ(all[1].sequence, 4U);
  EXPECT_EQ(history.Since("a", 3).size(), 1U);
  EXPECT_EQ(history.Since("b", 0).size(), 1U);
  EXPECT_TRUE(history.Since("c", 0).empty());
}

TEST(MetricsTest, HistogramsAreCumulated) {
  Metrics metrics;
  metrics.CountLocalization({"hall", "localized"}, 0.003);
  metrics.CountLocalization({"hall", "localized"}, 0.02);
  metrics.CountLocalization({"hall", "localized"}, 100.0);
  metrics.CountMessage({"hall", "used_late"});
  metrics.CountFix({"hall", "mahalanobis"});
  const std::string text =
      metrics.Render({{"floorloc_x", "Help.", 7.0}, {"floorloc_y", "Help.", 1.0, "status=\"lost\""}});
  for (const char* line : {"floorloc_x 7\n", "floorloc_y{status=\"lost\"} 1\n",
                           "floorloc_vehicle_messages_total{map=\"hall\",outcome=\"used_late\"} 1\n",
                           "floorloc_vehicle_fixes_total{map=\"hall\",outcome=\"mahalanobis\"} 1\n",
                           "floorloc_localize_total{map=\"hall\",status=\"localized\"} 3\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"0.002\"} 0\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"0.004\"} 1\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"10\"} 2\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"+Inf\"} 3\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace floorloc
