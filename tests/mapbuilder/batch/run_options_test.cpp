// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/run_options.h"

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(RunOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<RunOptions>().Refuses("threads", &RunOptions::threads, {-1});
}

}  // namespace
}  // namespace floorloc
