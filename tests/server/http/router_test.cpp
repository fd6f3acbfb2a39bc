// SPDX-License-Identifier: Apache-2.0
#include "server/http/router.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace floorloc
