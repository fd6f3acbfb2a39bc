// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <ostream>

namespace floorloc {
namespace {

// Below this angle the closed forms of Exp and Log lose digits (0/0), while their series are exact to double precision.
constexpr double kSmallAngle = 1e-4;

// The matrix V of SE(2)'s exponential: t = V(omega) * v. (Eade, "Lie Groups for 2D and 3D Transformations", eq. 135.)
Eigen::Matrix2d ExpTranslation(double omega) {
  double sin_over = 1.0 - omega * omega / 6.0;
  double versine_over = omega / 2.0;
  if (std::abs(omega) >= kSmallAngle) {
    sin_over = std::sin(omega) / omega;
    versine_over = (1.0 - std::cos(omega)) / omega;
  }
  Eigen::Matrix2d v;
  v << sin_over, -versine_over, versine_over, sin_over;
  return v;
}

}  // namespace

double WrapAngle(double angle_rad) {
  constexpr double kPi = std::numbers::pi;
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

Pose2::Pose2(double x_m, double y_m, double yaw_rad) : x_(x_m), y_(y_m), yaw_(WrapAngle(yaw_rad)) {}

Eigen::Matrix2d Pose2::rotation() const {
  const double c = std::cos(yaw_);
  const double s = std::sin(yaw_);
  Eigen::Matrix2d r;
  r << c, -s, s, c;
  return r;
}

Pose2 Pose2::Inverse() const {
  const Eigen::Vector2d t = -(rotation().transpose() * translation());
  return {t.x(), t.y(), -yaw_};
}

Pose2 Pose2::operator*(const Pose2& other) const {
  const Eigen::Vector2d t = *this * other.translation();
  return {t.x(), t.y(), yaw_ + other.yaw_};
}

Eigen::Vector2d Pose2::operator*(const Eigen::Vector2d& point) const { return rotation() * point + translation(); }

Pose2 Pose2::Exp(const Eigen::Vector3d& twist) {
  const Eigen::Vector2d t = ExpTranslation(twist.z()) * twist.head<2>();
  return {t.x(), t.y(), twist.z()};
}

Eigen::Vector3d Pose2::Log() const {
  const Eigen::Vector2d v = ExpTranslation(yaw_).inverse() * translation();
  return {v.x(), v.y(), yaw_};
}

Eigen::Matrix3d Pose2::Adjoint() const {
  Eigen::Matrix3d adjoint = Eigen::Matrix3d::Identity();
  adjoint.topLeftCorner<2, 2>() = rotation();
  adjoint(0, 2) = y_;
  adjoint(1, 2) = -x_;
  return adjoint;
}

bool Pose2::IsFinite() const { return std::isfinite(x_) && std::isfinite(y_) && std::isfinite(yaw_); }

std::ostream& operator<<(std::ostream& out, const Pose2& pose) {
  return out << "(" << pose.x() << " m, " << pose.y() << " m, " << pose.yaw() << " rad)";
}

}  // namespace floorloc
