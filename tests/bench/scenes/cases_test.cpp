// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/cases.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace floorloc {
namespace {

TEST(ConditionCasesTest, OnlyHardFramesSeeAPartOfTheRobot) {
  int hard = 0;
  for (const ConditionCase& condition : ConditionCases()) {
    ASSERT_EQ(condition.overlay != nullptr, condition.name == "hard") << condition.name;
    if (condition.overlay) {
      const cv::Mat& region = condition.overlay->region();
      EXPECT_NEAR(cv::countNonZero(region) / static_cast<double>(region.total()), 0.05, 0.01);
      ++hard;
    }
  }
  EXPECT_EQ(hard, 1);
}

}  // namespace
}  // namespace floorloc
