// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/vehicle_tracker.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(TrackingOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<PriorOptions>()
      .Refuses("sigmas", &PriorOptions::sigmas, {0.0})
      .Refuses("min_radius_m", &PriorOptions::min_radius_m, {0.0})
      .Refuses("max_radius_m", &PriorOptions::max_radius_m, {0.01})
      .Refuses("min_yaw_radius_rad", &PriorOptions::min_yaw_radius_rad, {0.0})
      .Refuses("max_yaw_radius_rad", &PriorOptions::max_yaw_radius_rad, {0.01});
  OptionTable<NextFrameOptions>()
      .Refuses("max_s", &NextFrameOptions::max_s, {0.0})
      .Refuses("max_m", &NextFrameOptions::max_m, {0.0});
}

TEST(TrackingOptionsTest, ATrackerChecksAllOfThem) {
  TrackerOptions options;
  EXPECT_EQ(Diagnostic(options), "");
  options.prior.sigmas = -1.0;
  EXPECT_THROW(VehicleTracker(options, 1e-3), std::invalid_argument);
  options = {};
  options.next.max_m = 0.0;
  EXPECT_THROW(VehicleTracker(options, 1e-3), std::invalid_argument);
  options = {};
  options.filter.history_s = 0.0;
  EXPECT_THAT(Diagnostic(options), testing::HasSubstr("history_s"));
}

}  // namespace
}  // namespace floorloc
