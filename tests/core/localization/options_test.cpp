// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(LocalizationOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<LocalizerOptions>()
      .Refuses("max_ratio_float", &LocalizerOptions::max_ratio_float, {0.0F, 1.1F})
      .Refuses("max_ratio_binary", &LocalizerOptions::max_ratio_binary, {0.0F, 1.1F})
      .Refuses("systematic_m", &LocalizerOptions::systematic_m, {-1.0})
      .Refuses("systematic_share", &LocalizerOptions::systematic_share, {-1.0});
  LocalizerOptions options;
  options.index.trees = 0;
  EXPECT_THAT(Diagnostic(options), testing::HasSubstr("trees"));
}

}  // namespace
}  // namespace floorloc
