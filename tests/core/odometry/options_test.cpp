// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/floor_view.h"
#include "core/odometry/monocular_odometry.h"
#include "core/odometry/planar_odometry.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(OdometryOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<ViewRegistrationOptions>()
      .Refuses("resolution_m", &ViewRegistrationOptions::resolution_m, {0.0, 1.0})
      .Refuses("max_ratio_binary", &ViewRegistrationOptions::max_ratio_binary, {0.0F, 1.1F})
      .Refuses("max_ratio_float", &ViewRegistrationOptions::max_ratio_float, {0.0F, 1.1F})
      .Refuses("systematic_m", &ViewRegistrationOptions::systematic_m, {-1e-4})
      .Refuses("systematic_rad", &ViewRegistrationOptions::systematic_rad, {-1e-4})
      .Refuses("min_inlier_share", &ViewRegistrationOptions::min_inlier_share, {-0.1, 1.0})
      .Refuses("local_share", &ViewRegistrationOptions::local_share, {-0.1, 1.0})
      .Refuses("min_rest_share", &ViewRegistrationOptions::min_rest_share, {-0.1, 1.0});
  OptionTable<PlanarOdometryOptions>()
      .Refuses("resolution_m", &PlanarOdometryOptions::resolution_m, {0.0})
      .Refuses("max_ratio_binary", &PlanarOdometryOptions::max_ratio_binary, {0.0F})
      .Refuses("max_ratio_float", &PlanarOdometryOptions::max_ratio_float, {0.0F})
      .Refuses("systematic_m", &PlanarOdometryOptions::systematic_m, {-1.0})
      .Refuses("systematic_rad", &PlanarOdometryOptions::systematic_rad, {-1.0})
      .Refuses("min_inlier_share", &PlanarOdometryOptions::min_inlier_share, {1.0})
      .Refuses("min_overlap", &PlanarOdometryOptions::min_overlap, {-0.1})
      .Refuses("max_speed_m_s", &PlanarOdometryOptions::max_speed_m_s, {0.0});
  OptionTable<MonocularOdometryOptions>()
      .Refuses("noise_px", &MonocularOdometryOptions::noise_px, {0.0})
      .Refuses("min_parallax_px", &MonocularOdometryOptions::min_parallax_px, {0.0})
      .Refuses("keyframe_parallax_px", &MonocularOdometryOptions::keyframe_parallax_px, {0.0})
      .Refuses("min_points", &MonocularOdometryOptions::min_points, {9})
      .Refuses("min_inlier_share", &MonocularOdometryOptions::min_inlier_share, {0.0});
}

}  // namespace
}  // namespace floorloc
