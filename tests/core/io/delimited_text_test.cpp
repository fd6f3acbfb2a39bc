// SPDX-License-Identifier: Apache-2.0
#include "core/io/delimited_text.h"

#include <gmock/gmock.h>

#include <string>

namespace floorloc {
namespace {

using testing::ElementsAre;
using testing::Optional;

TEST(SplitCsv, ReadsFieldsWithAndWithoutQuotes) {
  EXPECT_THAT(SplitCsv("a, b ,c"), Optional(ElementsAre("a", "b", "c")));
  EXPECT_THAT(SplitCsv("\"a,b\" , \" c \""), Optional(ElementsAre("a,b", " c ")));
  EXPECT_THAT(SplitCsv("\"a \"\"b\"\"\",\"\",c\"d"), Optional(ElementsAre("a \"\"b\"\"", "", "c\"d")));
  EXPECT_THAT(SplitCsv(","), Optional(ElementsAre("", "")));
  EXPECT_THAT(SplitCsv(""), Optional(ElementsAre("")));
}

TEST(SplitCsv, RefusesQuotesThatDoNotEnclose) {
  for (const std::string text : {"\"", "\"a", "\"a\"b", "a,\"b\"\"", "\"a\" b,c", "\"\"\""}) {
    EXPECT_FALSE(SplitCsv(text)) << text;
  }
}

TEST(ParseSize, ReadsTwoDecimalNumbers) {
  EXPECT_THAT(ParseSize("2.6x1.8"), Optional(ElementsAre(2.6, 1.8)));
  EXPECT_THAT(ParseSize("12X7."), Optional(ElementsAre(12.0, 7.0)));
}

TEST(ParseSize, RefusesWhatIsNotTwoDecimalNumbers) {
  const std::string endless(400, '9');
  for (const std::string text : {"", "x", "2.6", "2.6x", "x1.8", "2.6x1.8x3", "2.6xx1.8", "-2.6x1.8", "+2.6x1.8",
                                 ".6x1.8", "2.6.1x1.8", "2.6 x 1.8", "1e3x1.8", "infxnan", "0x1p3", "2.6*1.8"}) {
    EXPECT_FALSE(ParseSize(text)) << text;
  }
  EXPECT_FALSE(ParseSize(endless + "x1"));
}

TEST(ParseGridSize, ReadsTwoNumbersOfUpToThreeDigits) {
  EXPECT_THAT(ParseGridSize("9x6"), Optional(ElementsAre(9, 6)));
  EXPECT_THAT(ParseGridSize("007X999"), Optional(ElementsAre(7, 999)));
}

TEST(ParseGridSize, RefusesWhatIsNotTwoNumbersOfUpToThreeDigits) {
  for (const std::string text :
       {"", "x", "9", "9x", "x6", "9x6x2", "9.0x6", "-9x6", "1000x6", "9x0006", "9x6 ", " 9x6"}) {
    EXPECT_FALSE(ParseGridSize(text)) << text;
  }
}

}  // namespace
}  // namespace floorloc
