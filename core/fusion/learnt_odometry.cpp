// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/learnt_odometry.h"

namespace floorloc {

LearntOdometry LearntIn(const FilterState& state) {
  using error_row::kOdometryScale;
  return {state.odometry_bias, state.covariance.block<3, 3>(kOdometryScale, kOdometryScale), state.wheel_noise_factor,
          0};
}

void Resume(const LearntOdometry& learnt, FilterState* state) {
  using error_row::kOdometryScale;
  state->odometry_bias = learnt.bias;
  state->covariance.block<3, 3>(kOdometryScale, kOdometryScale) = learnt.covariance;
  state->wheel_noise_factor = learnt.noise_factor;
}

}  // namespace floorloc
