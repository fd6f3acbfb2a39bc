// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <iosfwd>

namespace floorloc {

/// Wraps an angle to (-pi, pi].
double WrapAngle(double angle_rad);

/// A rigid motion of the plane, SE(2). Named target_from_source: x_in_target = R(yaw) * x_in_source + t.
/// As a robot's pose (map_from_base) its translation is the position in the map. Metres, radians.
class Pose2 {
 public:
  Pose2() = default;
  Pose2(double x_m, double y_m, double yaw_rad);

  double x() const { return x_; }
  double y() const { return y_; }
  double yaw() const { return yaw_; }
  Eigen::Vector2d translation() const { return {x_, y_}; }
  Eigen::Matrix2d rotation() const;

  Pose2 Inverse() const;
  /// a_from_c = a_from_b * b_from_c.
  Pose2 operator*(const Pose2& other) const;
  /// x_in_target = pose * x_in_source.
  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const;
  /// this^-1 * other: the motion from this pose to the other, in this pose's frame.
  Pose2 Between(const Pose2& other) const { return Inverse() * other; }

  /// Exponential map: the motion of a body that moves with the constant twist (vx, vy, omega) for unit time.
  static Pose2 Exp(const Eigen::Vector3d& twist);
  /// Inverse of Exp, for |yaw| < pi.
  Eigen::Vector3d Log() const;
  /// Adjoint matrix: p * Exp(xi) == Exp(p.Adjoint() * xi) * p.
  Eigen::Matrix3d Adjoint() const;

  bool IsFinite() const;

 private:
  double x_ = 0.0;
  double y_ = 0.0;
  double yaw_ = 0.0;  // in (-pi, pi]
};

std::ostream& operator<<(std::ostream& out, const Pose2& pose);

}  // namespace floorloc
