// SPDX-License-Identifier: Apache-2.0
#include "server/serving/fix_history.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

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

}  // namespace
}  // namespace floorloc
