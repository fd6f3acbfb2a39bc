// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/io/trajectory.h"

namespace floorloc {

/// Mean twist (vx, vy, omega) of a trajectory's body over a few hundredths of a second about a time, m/s and rad/s, in
/// the body's frame. Empty where the trajectory has a gap, or ends.
std::optional<Eigen::Vector3d> TwistAt(const Trajectory& trajectory, std::int64_t stamp_ns);

}  // namespace floorloc
