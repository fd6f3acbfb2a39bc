// SPDX-License-Identifier: Apache-2.0
#include "server/serving/message_stamps.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "core/io/trajectory.h"

namespace floorloc {
namespace {

TEST(StampTest, KeepsEveryDigit) {
  EXPECT_EQ(ParseStampNs("1700000000.123456789"), 1'700'000'000'123'456'789);
  EXPECT_EQ(ParseStampNs("-1.5"), -1'500'000'000);
  EXPECT_EQ(ParseStampNs("-0.000000001"), -1);
  EXPECT_EQ(ParseStampNs("0"), 0);
  EXPECT_EQ(ParseStampNs("1.5e3"), 1'500'000'000'000);
  EXPECT_EQ(ParseStampNs("4000000000"), 4'000'000'000'000'000'000);
  EXPECT_EQ(ParseStampNs("1.0000000019"), 1'000'000'002);
}

TEST(StampTest, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "now", "1s", "nan", "inf", "-inf", "1e10", "4000000000.5", "1,5", " 1", "0x10", "1e999"}) {
    EXPECT_EQ(ParseStampNs(text), std::nullopt) << text;
  }
  EXPECT_EQ(ToStampNs(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
  EXPECT_EQ(ToStampNs(-4.1e9), std::nullopt);
}

TEST(StampTest, NumbersMeanWhatTheySay) {
  EXPECT_EQ(ToStampNs(1700000000.1), 1'700'000'000'100'000'000);
  EXPECT_EQ(ToStampNs(5e-324), 0);
  for (const double seconds : {1700000000.1, -1234.5, 0.0, 1234567890.123456, 3999999999.9}) {
    EXPECT_EQ(ToSeconds(*ToStampNs(seconds)), seconds);
  }
}

TEST(MessageStampsTest, RemembersAWindowAndTheNewest) {
  MessageStamps stamps(10);
  EXPECT_EQ(stamps.Newest(), std::nullopt);
  EXPECT_FALSE(stamps.IsTooOld(-100));
  for (const std::int64_t stamp : {100, 104, 102}) {
    stamps.Add(stamp);
  }
  EXPECT_EQ(stamps.Newest(), 104);
  EXPECT_EQ(stamps.Before(104), 102);
  EXPECT_EQ(stamps.Before(100), std::nullopt);
  EXPECT_TRUE(stamps.IsTooOld(93));
  EXPECT_FALSE(stamps.IsTooOld(94));
  stamps.Add(1000);
  EXPECT_FALSE(stamps.Contains(104));
  EXPECT_EQ(stamps.Before(1001), 1000);
}

TEST(MessageStampsTest, IsBounded) {
  MessageStamps stamps(1'000'000);
  for (std::int64_t stamp = 0; stamp < 10'000; ++stamp) {
    stamps.Add(stamp);
  }
  EXPECT_FALSE(stamps.Contains(0));
  EXPECT_TRUE(stamps.Contains(9'000));
}

}  // namespace
}  // namespace floorloc
