// SPDX-License-Identifier: Apache-2.0
#include "server/wire/strict_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

std::string Nested(int depth) {
  const auto count = static_cast<std::size_t>(depth);
  return std::string(count, '[') + std::string(count, ']');
}

TEST(StrictJsonTest, DeepNestingIsRefusedBeforeItCostsMemory) {
  EXPECT_NO_THROW(ParseJson(Nested(32)));
  EXPECT_THROW(ParseJson(Nested(33)), MalformedJson);
  EXPECT_THROW(ParseJson(std::string(1'000'000, '[')), MalformedJson);
  EXPECT_NO_THROW(ParseJson("[" + Nested(20) + "," + Nested(20) + "]"));
}

TEST(StrictJsonTest, BracketsInTextsAreNoNesting) {
  EXPECT_EQ(ParseJson("[\"" + std::string(100, '[') + "\"]")[0], std::string(100, '['));
  EXPECT_EQ(ParseJson("[\"\\\"" + std::string(100, '{') + "\"]")[0], '"' + std::string(100, '{'));
}

}  // namespace
}  // namespace floorloc
