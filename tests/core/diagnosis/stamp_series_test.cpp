// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/stamp_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace floorloc {
namespace {

using ::testing::ElementsAre;

StampSeries Series(std::initializer_list<std::int64_t> seconds, std::size_t max_size = 100) {
  StampSeries series(max_size);
  for (const std::int64_t s : seconds) {
    series.Add(1'000'000'000 * s);
  }
  return series;
}

TEST(StampSeriesTest, CountsWhatRunsBackward) {
  const StampSeries series = Series({10, 11, 11, 13, 3, 4});
  EXPECT_EQ(series.CountBackward(), 2U);
  EXPECT_EQ(series.LargestStepBackS(), 10.0);
  EXPECT_THAT(series.StepsS(), ElementsAre(1.0, 2.0, 1.0));
  EXPECT_EQ(series.Range().first_ns, 3'000'000'000);
  EXPECT_EQ(series.Range().last_ns, 13'000'000'000);
  EXPECT_EQ(series.newest_ns(), 4'000'000'000);
}

TEST(StampSeriesTest, ForgetsTheOldest) {
  const StampSeries series = Series({10, 1, 2, 3}, 3);
  EXPECT_EQ(series.size(), 3U);
  EXPECT_EQ(series.CountBackward(), 0U);
}

TEST(StampSeriesTest, HasNothingToSayWhenEmpty) {
  EXPECT_TRUE(Series({}).empty());
  EXPECT_EQ(Series({}).CountBackward(), 0U);
  EXPECT_EQ(Series({}).LargestStepBackS(), 0.0);
  EXPECT_TRUE(Series({}).StepsS().empty());
}

}  // namespace
}  // namespace floorloc
