// SPDX-License-Identifier: Apache-2.0
#include "server/wire/strict_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

std::string Nested(int depth) {
  const auto count = static_cast<std::size_t>(depth);
  return std::string(count, '[') + std::string(count, ']');
}

TEST(StrictJsonTest, DeepNestingIsRefusedBeforeItCostsMemory) {
  EXPECT_NO_THROW(ParseJson(Nested(16)));
  EXPECT_THROW(ParseJson(Nested(17)), MalformedJson);
  EXPECT_THROW(ParseJson(std::string(200'000, '[')), MalformedJson);
  EXPECT_NO_THROW(ParseJson("[" + Nested(15) + "," + Nested(15) + "]"));
}

TEST(StrictJsonTest, LargeTextsAreRefusedBeforeTheyCostMemory) {
  const std::string wide(300'000, ' ');
  EXPECT_THROW(ParseJson("[1" + wide + "]"), OversizedJson);
  EXPECT_THROW(ParseJson("[1" + wide + "]", kMaxJsonBytesWithMask), OversizedJson);
  EXPECT_NO_THROW(ParseJson("[\"" + wide + "\"]", kMaxJsonBytesWithMask));
  EXPECT_THROW(ParseJson("[\"" + wide + "\"]"), OversizedJson);
  EXPECT_THROW(ParseJson("[\"" + std::string(3 << 20, ' ') + "\"]", kMaxJsonBytesWithMask), OversizedJson);
}

TEST(StrictJsonTest, AKeyIsGivenOnce) {
  for (const char* text : {R"({"a":1,"a":2})", R"([{"b":{"a":1,"c":[{}],"a":2}}])", R"({"a":1,"\u0061":2})"}) {
    EXPECT_THAT([&] { ParseJson(text); },
                testing::ThrowsMessage<MalformedJson>(testing::HasSubstr("'a' is given twice")));
  }
  EXPECT_NO_THROW(ParseJson(R"({"a":{"a":1},"b":[{"a":1},{"a":2}]})"));
}

TEST(StrictJsonTest, BracketsInTextsAreNoNesting) {
  EXPECT_EQ(ParseJson("[\"" + std::string(100, '[') + "\"]")[0], std::string(100, '['));
  EXPECT_EQ(ParseJson("[\"\\\"" + std::string(100, '{') + "\"]")[0], '"' + std::string(100, '{'));
}

}  // namespace
}  // namespace floorloc
