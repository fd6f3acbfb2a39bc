// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>
#include <vector>

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(ProgressBar, PrintsOnePlainLinePerTenPercent) {
  std::ostringstream out;
  {
    ProgressBar bar("Rendering", 200, {&out, false, std::chrono::milliseconds(0)});
    for (int i = 0; i < 200; ++i) {
      bar.Advance();
    }
  }
  const std::string text = out.str();
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_THAT(text, StartsWith("Rendering: 10 % 20/200, "));
  EXPECT_THAT(text, HasSubstr("Rendering: 100 % 200/200, "));
}

TEST(ProgressBar, AStageThatIsSoonDoneHasOnePlainLine) {
  for (const int items : {1, 7, 10, 500}) {
    std::ostringstream out;
    {
      ProgressBar bar("Rendering", items, {&out, false});
      for (int i = 0; i < items; ++i) {
        bar.Advance();
      }
    }
    EXPECT_EQ(std::ranges::count(out.str(), '\n'), 1);
    EXPECT_THAT(out.str(), StartsWith("Rendering: 100 % "));
  }
}

TEST(ProgressBar, PlainLinesKeepTheirDistance) {
  std::ostringstream out;
  {
    ProgressBar bar("Rendering", 3, {&out, false, std::chrono::milliseconds(20)});
    bar.Advance();  // at once: no line
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    bar.Advance();
    bar.Advance();
  }
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 2);
  EXPECT_THAT(out.str(), StartsWith("Rendering: 66 % 2/3"));
  EXPECT_THAT(out.str(), HasSubstr("100 % 3/3"));
}

TEST(ProgressBar, CountsStepsOfManyThreads) {
  std::ostringstream out;
  {
    ProgressBar bar("Work", 4000, {&out, false});
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&bar] {
        for (int i = 0; i < 1000; ++i) {
          bar.Advance();
        }
      });
    }
    std::ranges::for_each(threads, &std::thread::join);
  }
  EXPECT_THAT(out.str(), HasSubstr("4000/4000"));
}

TEST(ProgressBar, RedrawsInPlaceAndEndsItsLine) {
  std::ostringstream out;
  {
    ProgressBar bar("Work", 2, {&out, true});
    bar.Advance(2);
  }
  EXPECT_THAT(out.str(), StartsWith("\rWork [....."));
  EXPECT_THAT(out.str(), HasSubstr("\rWork [##############################] 100 % 2/2"));
  EXPECT_EQ(out.str().back(), '\n');
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 1);
}

TEST(ProgressBar, IsSilentByDefaultAndAcceptsNothingToDo) {
  ProgressBar silent("Work", 5, {});
  silent.Advance(5);
  std::ostringstream out;
  {
    ProgressBar empty("Work", 0, {&out, true});
    empty.Advance();
  }
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace floorloc
