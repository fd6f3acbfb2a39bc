// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/motion_pairs.h"
#include "core/evaluation/trajectory_evaluation.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(EvaluationOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<EvaluationOptions>()
      .Refuses("max_diff_s", &EvaluationOptions::max_diff_s, {-0.1})
      .Refuses("time_offset_s", &EvaluationOptions::time_offset_s, {std::numeric_limits<double>::infinity()});
  OptionTable<MotionOptions>()
      .Refuses("delta", &MotionOptions::delta, {0.0, -1.0})
      .Refuses("delta", &MotionOptions::relative_tolerance, {-0.1});
}

TEST(EvaluationOptionsTest, TheyAreCheckedFirst) {
  EvaluationOptions options;
  options.max_diff_s = -1.0;
  EXPECT_THROW(EvaluateTrajectory({}, {}, options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
