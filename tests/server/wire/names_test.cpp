// SPDX-License-Identifier: Apache-2.0
#include "server/wire/names.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

TEST(NamesTest, AreSafeInUrlsAndFileNames) {
  EXPECT_TRUE(IsMapName("Hall_2-b"));
  EXPECT_TRUE(IsVehicleId("agv.7"));
  for (const char* wrong : {"", "a/b", "a b", "..%2f", "\xC3\xA4"}) {
    EXPECT_FALSE(IsMapName(wrong)) << wrong;
    EXPECT_FALSE(IsVehicleId(wrong)) << wrong;
  }
  EXPECT_FALSE(IsVehicleId("."));
  EXPECT_FALSE(IsVehicleId(".."));
  EXPECT_TRUE(IsVehicleId("..."));
  EXPECT_FALSE(IsMapName("a.b"));
  EXPECT_FALSE(IsMapName(std::string(65, 'a')));
  EXPECT_TRUE(IsMapName(std::string(64, 'a')));
}

}  // namespace
}  // namespace floorloc
