// SPDX-License-Identifier: Apache-2.0
#include "server/wire/base64.h"

#include <gtest/gtest.h>

#include <vector>

namespace floorloc {
namespace {

// RFC 4648, section 10.
TEST(Base64Test, EncodesAndDecodesTheVectorsOfTheStandard) {
  const std::vector<std::pair<std::string, std::string>> vectors = {{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {"foobar", "Zm9vYmFy"},
                                                                    {"\xFB\xFF", "+/8="}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(EncodeBase64(std::vector<std::uint8_t>(bytes.begin(), bytes.end())), text);
    EXPECT_EQ(DecodeBase64(text), bytes) << text;
  }
}

TEST(Base64Test, RejectsWhatIsNoBase64) {
  for (const char* text : {"Zg=", "Zg", "Z===", "Zg==Zg==", "Zm9v\n", "Zm9 ", "=Zm9", "Zm-_"}) {
    EXPECT_FALSE(DecodeBase64(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace floorloc
