// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fusion_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Printed(const FusionScore& score) {
  std::ostringstream out;
  PrintFusionTables(out, {{"ours"}}, {{"rain", {score}}});
  return out.str();
}

TEST(FusionTables, ShowErrorsHonestyAndConsistency) {
  FusionScore score;
  score.samples = 200;
  score.called_good = 150;
  score.wrong_called_good = 3;
  score.judged = 100;
  score.squared_error_m2 = 100 * 0.012 * 0.012;
  score.nees = 270.0;
  score.worst_jump_m = 0.0045;
  const std::string text = Printed(score);
  EXPECT_THAT(text, HasSubstr("| rain | 12 (4.5) |"));
  EXPECT_THAT(text, HasSubstr("| rain | 1.5 (75.0) |"));
  EXPECT_THAT(text, HasSubstr("| rain | 2.7 |"));
  EXPECT_THAT(text, Not(HasSubstr("found again after, s")));
}

TEST(FusionTables, ShowRecoveries) {
  FusionScore score;
  score.never_recovered = 1;
  EXPECT_THAT(Printed(score), HasSubstr("| rain | never |"));
  score.recovery_s = {0.3, 2.0, 0.5};
  EXPECT_THAT(Printed(score), HasSubstr("| rain | 0.5 (2.0), 3 of 4 |"));
  score.never_recovered = 0;
  EXPECT_THAT(Printed(score), HasSubstr("| rain | 0.5 (2.0) |"));
}

}  // namespace
}  // namespace floorloc
