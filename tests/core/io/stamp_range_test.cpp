// SPDX-License-Identifier: Apache-2.0
#include "core/io/stamp_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/io/trajectory.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

constexpr double kUnixS = 1'700'000'000.0;

StampRange Range(double first_s, double last_s) { return {std::llround(1e9 * first_s), std::llround(1e9 * last_s)}; }

TEST(StampRangeTest, IsOfAListInOrder) {
  const Trajectory odometry = {{5, {}, {}}, {7, {}, {}}, {9, {}, {}}};
  EXPECT_EQ(StampRange::Of(odometry).first_ns, 5);
  EXPECT_EQ(StampRange::Of(odometry).last_ns, 9);
}

TEST(CompareClocksTest, RangesThatTouchAreOfOneClock) {
  EXPECT_FALSE(CompareClocks(Range(10, 20), Range(20, 30), "odometry"));
  EXPECT_FALSE(CompareClocks(Range(10, 20), Range(0, 10), "odometry"));
  EXPECT_TRUE(CompareClocks(Range(10, 20), Range(20.1, 30), "odometry"));
  EXPECT_FALSE(CompareClocks(Range(10, 20), Range(20.1, 30), "odometry", 0.2));
}

TEST(CompareClocksTest, TheSentenceHasBothRanges) {
  const auto apart = CompareClocks(Range(kUnixS, kUnixS + 12), Range(40, 52), "odometry");
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->sentence, "images are stamped from 1700000000.0 to 1700000012.0 s, odometry from 40.0 to 52.0 s");
}

// What the cure says of images and another sender that are stamped like this.
std::string Cure(const StampRange& images, const StampRange& other) {
  const auto apart = CompareClocks(images, other, "odometry");
  return apart ? apart->cure : "";
}

TEST(CompareClocksTest, TheCureNamesTheEpoch) {
  EXPECT_THAT(Cure(Range(kUnixS, kUnixS + 12), Range(40, 52)),
              HasSubstr("stamps of the images are Unix time, those of odometry count since something was started"));
  EXPECT_THAT(Cure(Range(40, 52), Range(kUnixS, kUnixS + 12)), HasSubstr("stamps of odometry are Unix time"));
}

TEST(CompareClocksTest, TheCureNamesTheUnit) {
  EXPECT_THAT(Cure(Range(kUnixS, kUnixS + 12), Range(kUnixS * 1e-3, kUnixS * 1e-3 + 1e-2)),
              HasSubstr("stamps of the images are to those of odometry as milliseconds are to seconds"));
  EXPECT_THAT(Cure(Range(100, 112), Range(101e3, 113e3)),
              HasSubstr("stamps of odometry are to those of the images as milliseconds are to seconds"));
  EXPECT_THAT(Cure(Range(100, 112), Range(101e6, 113e6)), HasSubstr("microseconds"));
}

TEST(CompareClocksTest, TheCureNamesATimeZone) {
  EXPECT_THAT(Cure(Range(kUnixS, kUnixS + 12), Range(kUnixS + 7203, kUnixS + 7215)), HasSubstr("2.0 h apart"));
  EXPECT_THAT(Cure(Range(kUnixS, kUnixS + 12), Range(kUnixS - 19799, kUnixS - 19787)), HasSubstr("5.5 h apart"));
  EXPECT_EQ(Cure(Range(kUnixS, kUnixS + 12), Range(kUnixS + 700, kUnixS + 712)), "give both the same clock");
}

TEST(CompareClocksTest, AnotherUnitOrEpochIsNotOneClockAtTwoTimes) {
  EXPECT_TRUE(CompareClocks(Range(kUnixS, kUnixS + 12), Range(40, 52), "odometry")->of_other_scale);
  EXPECT_TRUE(CompareClocks(Range(100, 112), Range(101e3, 113e3), "odometry")->of_other_scale);
  EXPECT_FALSE(CompareClocks(Range(kUnixS, kUnixS + 12), Range(kUnixS + 7203, kUnixS + 7215), "")->of_other_scale);
  EXPECT_FALSE(CompareClocks(Range(kUnixS, kUnixS + 12), Range(kUnixS + 700, kUnixS + 712), "")->of_other_scale);
}

TEST(HintAboutUnitTest, NamesTheUnitOfAStampSince1970) {
  EXPECT_EQ(HintAboutUnit("1700000000123"), "it looks like milliseconds since 1970: divide by 1000");
  EXPECT_EQ(HintAboutUnit("1700000000123456"), "it looks like microseconds since 1970: divide by 1000000");
  EXPECT_EQ(HintAboutUnit("1700000000123456789"), "it looks like nanoseconds since 1970: divide by 1000000000");
  for (const char* other : {"", "abc", "9e9", "1e30", "nan"}) {
    EXPECT_EQ(HintAboutUnit(other), std::nullopt) << other;
  }
}

}  // namespace
}  // namespace floorloc
