// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/motion_covariance.h"

#include <Eigen/Eigenvalues>

namespace floorloc {
namespace {

// Lever arm that converts radians to metres before the eigenvalues are clamped.
constexpr double kLeverM = 0.25;

Eigen::Matrix3d RotationOf(const Pose2& pose) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = pose.rotation();
  return rotation;
}

// Derivative of the error after a motion by the error before it, in the target frame: an error of yaw rotates the
// shift.
Eigen::Matrix3d PropagationJacobian(const Eigen::Vector2d& shift) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -shift.y();
  jacobian(1, 2) = shift.x();
  return jacobian;
}

Eigen::Matrix3d ClampToPositiveSemidefinite(const Eigen::Matrix3d& symmetric) {
  const Eigen::Vector3d scale(1.0, 1.0, kLeverM);
  const Eigen::Matrix3d balanced = scale.asDiagonal() * symmetric * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(balanced);
  const Eigen::Matrix3d& axes = solver.eigenvectors();
  const Eigen::Matrix3d positive = axes * solver.eigenvalues().cwiseMax(0.0).asDiagonal() * axes.transpose();
  const Eigen::Vector3d back = scale.cwiseInverse();
  return back.asDiagonal() * positive * back.asDiagonal();
}

Eigen::Vector2d Shift(const Pose2& from, const Pose2& to) { return to.translation() - from.translation(); }

}  // namespace

Eigen::Matrix3d MotionCovariance(const AnchoredPose& from, const AnchoredPose& to) {
  const Eigen::Matrix3d propagation = PropagationJacobian(Shift(from.anchor_from_base, to.anchor_from_base));
  const double own_share = from.covariance.isZero(0.0) ? 1.0 : 0.5;
  const Eigen::Matrix3d in_anchor =
      own_share * (to.covariance + propagation * from.covariance * propagation.transpose());
  const Eigen::Matrix3d rotation = RotationOf(from.anchor_from_base);
  return rotation.transpose() * in_anchor * rotation;
}

Eigen::Matrix3d IncrementalCovariance(const AnchoredPose& from, const AnchoredPose& to) {
  const Eigen::Matrix3d propagation = PropagationJacobian(Shift(from.anchor_from_base, to.anchor_from_base));
  const Eigen::Matrix3d added =
      ClampToPositiveSemidefinite(to.covariance - propagation * from.covariance * propagation.transpose());
  const Eigen::Matrix3d rotation = RotationOf(from.anchor_from_base);
  return rotation.transpose() * added * rotation;
}

Eigen::Matrix3d PropagatedCovariance(const AnchoredPose& from, const Pose2& motion,
                                     const Eigen::Matrix3d& motion_covariance) {
  const Eigen::Matrix3d rotation = RotationOf(from.anchor_from_base);
  const Eigen::Matrix3d propagation = PropagationJacobian(from.anchor_from_base.rotation() * motion.translation());
  return propagation * from.covariance * propagation.transpose() + rotation * motion_covariance * rotation.transpose();
}

}  // namespace floorloc
