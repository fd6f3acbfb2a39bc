// SPDX-License-Identifier: Apache-2.0
#include "core/registration/registration.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(RegistrationOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<RegistrationOptions>()
      .Refuses("inlier_radius_m", &RegistrationOptions::inlier_radius_m, {0.0, 1.0})
      .Refuses("vote_cell_m", &RegistrationOptions::vote_cell_m, {0.0, 10.0})
      .Refuses("vote_cell_rad", &RegistrationOptions::vote_cell_rad, {0.01, 2.0})
      .Refuses("candidates", &RegistrationOptions::candidates, {0, 1001})
      .Refuses("ransac_iterations", &RegistrationOptions::ransac_iterations, {0})
      .Refuses("min_inliers", &RegistrationOptions::min_inliers, {2})
      .Refuses("max_p_wrong", &RegistrationOptions::max_p_wrong, {0.0, 1.1})
      .Refuses("position_noise_floor_m", &RegistrationOptions::position_noise_floor_m, {0.0});
}

}  // namespace
}  // namespace floorloc
