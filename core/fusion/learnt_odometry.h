// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/fusion/filter_state.h"

namespace floorloc {

/// What fixes taught about a vehicle's wheels; holds when its pose does not.
struct LearntOdometry {
  OdometryBias bias;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of scale, yaw scale and drift
  double noise_factor = 1.0;                             ///< FilterState::wheel_noise_factor
  std::int64_t offset_ns = 0;                            ///< how much later the wheels are stamped than the images
};

/// What a state knows of the wheels; offset_ns is not part of it.
LearntOdometry LearntIn(const FilterState& state);

/// Gives that to a state that knows nothing of them yet (InitialState).
void Resume(const LearntOdometry& learnt, FilterState* state);

}  // namespace floorloc
