// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/filter_options.h"
#include "core/fusion/jump_filter.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(FusionOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<JumpFilterOptions>()
      .Refuses("max_distance_m", &JumpFilterOptions::max_distance_m, {0.0, -1.0})
      .Refuses("max_angle_rad", &JumpFilterOptions::max_angle_rad, {0.0});
  OptionTable<KidnapOptions>()
      .Refuses("kidnap.fixes", &KidnapOptions::fixes, {0})
      .Refuses("kidnap.near_fixes", &KidnapOptions::near_fixes, {0})
      .Refuses("kidnap.max_distance_m", &KidnapOptions::max_distance_m, {0.0})
      .Refuses("kidnap.max_angle_rad", &KidnapOptions::max_angle_rad, {0.0})
      .Refuses("kidnap.sigmas", &KidnapOptions::sigmas, {-1.0})
      .Refuses("kidnap.max_age_s", &KidnapOptions::max_age_s, {0.0});
  OptionTable<OdometryMonitorOptions>()
      .Refuses("monitor.max_speed_m_s", &OdometryMonitorOptions::max_speed_m_s, {0.0})
      .Refuses("monitor.max_yaw_rate_rad_s", &OdometryMonitorOptions::max_yaw_rate_rad_s, {0.0})
      .Refuses("monitor.tolerance_scale", &OdometryMonitorOptions::tolerance_scale, {0.0})
      .Refuses("monitor.contradiction", &OdometryMonitorOptions::contradiction, {1.0})
      .Refuses("monitor.fixes", &OdometryMonitorOptions::fixes, {2})
      .Refuses("monitor.named_intervals", &OdometryMonitorOptions::named_intervals, {1})
      .Refuses("monitor.intervals_to_trust", &OdometryMonitorOptions::intervals_to_trust, {0})
      .Refuses("monitor.max_offset_s", &OdometryMonitorOptions::max_offset_s, {0.0})
      .Refuses("monitor.clock_min_intervals", &OdometryMonitorOptions::clock_min_intervals, {2})
      .Refuses("monitor.clock_max_left", &OdometryMonitorOptions::clock_max_left, {0.0});
  OptionTable<GyroMonitorOptions>()
      .Refuses("gyro_monitor.max_interval_s", &GyroMonitorOptions::max_interval_s, {0.0})
      .Refuses("gyro_monitor.tolerance_rad", &GyroMonitorOptions::tolerance_rad, {-1.0})
      .Refuses("gyro_monitor.contradictions", &GyroMonitorOptions::contradictions, {0})
      .Refuses("gyro_monitor.agreements", &GyroMonitorOptions::agreements, {0});
  OptionTable<PoseFilterOptions>()
      .Refuses("history_s", &PoseFilterOptions::history_s, {0.0})
      .Refuses("max_slip_mahalanobis_squared", &PoseFilterOptions::max_slip_mahalanobis_squared, {0.0})
      .Refuses("max_messages", &PoseFilterOptions::max_messages, {15})
      .Refuses("clock_jump_messages", &PoseFilterOptions::clock_jump_messages, {0});
}

TEST(FusionOptionsTest, WhatIsNestedIsCheckedToo) {
  PoseFilterOptions options;
  options.kidnap.fixes = 0;
  EXPECT_THAT(Diagnostic(options), testing::HasSubstr("kidnap.fixes"));
  options = {};
  options.monitor.fixes = 1;
  EXPECT_THAT(Diagnostic(options), testing::HasSubstr("monitor.fixes"));
  EXPECT_THROW(JumpFilter({0.0, 0.1}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
