// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/place_frames.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace floorloc {
namespace {

TEST(PlacementOptionsTest, RefusesNonsense) {
  EXPECT_NO_THROW(PlacementOptions().Check());
  for (const double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    PlacementOptions options;
    options.max_unmatched_share = bad;
    EXPECT_THROW(options.Check(), std::invalid_argument) << bad;
  }
  PlacementOptions options;
  options.prior_sigma_m = 0.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
