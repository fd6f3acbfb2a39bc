// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

/// Velocity of a point that moves with the base. twist: (vx, vy, omega), m/s and rad/s; point: base frame, metres.
inline Eigen::Vector2d VelocityAt(const Eigen::Vector3d& twist, const Eigen::Vector2d& point) {
  return twist.head<2>() + twist.z() * Eigen::Vector2d(-point.y(), point.x());
}

}  // namespace floorloc
