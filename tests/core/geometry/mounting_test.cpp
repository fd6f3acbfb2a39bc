// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/mounting.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace floorloc {
namespace {

constexpr int kRounds = 500;

using MountingVector4 = Eigen::Vector4d;  // rotation vector, height share

// Intersection of a floor point's ray with the floor after the camera is rotated about its centre and raised.
Eigen::Vector2d ObservedAt(const Eigen::Vector3d& center, const Eigen::Vector2d& point, const MountingVector4& error) {
  const Eigen::Vector3d rotation = error.head<3>();
  const Eigen::Vector3d ray(point.x() - center.x(), point.y() - center.y(), -center.z());
  const Eigen::Vector3d turned =
      rotation.norm() > 0.0 ? Eigen::AngleAxisd(rotation.norm(), rotation.normalized()) * ray : ray;
  const Eigen::Vector3d raised = center + Eigen::Vector3d(0.0, 0.0, error(3) * center.z());
  return (raised - turned * (raised.z() / turned.z())).head<2>();
}

// Cameras at random positions, and floor points from directly below to far ahead.
class MountingJacobianTest : public ::testing::Test {
 protected:
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  Eigen::Vector3d RandomCenter() { return {Uniform(-0.5, 0.5), Uniform(-0.5, 0.5), Uniform(0.05, 2.0)}; }
  Eigen::Vector2d RandomPoint(const Eigen::Vector3d& center) {
    const double reach = 2.0 * center.z();
    return center.head<2>() + Eigen::Vector2d(Uniform(-reach, reach), Uniform(-reach, reach));
  }

 private:
  std::mt19937_64 rng_{5};
};

TEST_F(MountingJacobianTest, IsTheDerivativeOfTheExactGeometry) {
  constexpr double kStep = 1e-5;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d center = RandomCenter();
    const Eigen::Vector2d point = RandomPoint(center);
    const Eigen::Matrix<double, 2, 4> jacobian = MountingJacobian(center, point);
    for (int i = 0; i < 4; ++i) {
      const MountingVector4 step = kStep * MountingVector4::Unit(i);
      const Eigen::Vector2d slope =
          (ObservedAt(center, point, step) - ObservedAt(center, point, -step)) / (2.0 * kStep);
      EXPECT_LT((jacobian.col(i) - slope).norm(), 1e-7 * (1.0 + slope.norm())) << "column " << i;
    }
  }
}

TEST_F(MountingJacobianTest, PredictsTheSumOfSmallErrorsToFirstOrder) {
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d center = RandomCenter();
    const Eigen::Vector2d point = RandomPoint(center);
    const MountingVector4 error =
        1e-3 * MountingVector4(Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1));
    const Eigen::Vector2d predicted = point + MountingJacobian(center, point) * error;
    // At points up to three heights from the camera the second derivatives reach about thirty heights.
    EXPECT_LT((predicted - ObservedAt(center, point, error)).norm(), 60.0 * center.z() * error.squaredNorm());
  }
}

TEST_F(MountingJacobianTest, UnderTheCameraATiltMovesTheFloorByTheHeight) {
  Eigen::Matrix<double, 2, 4> expected;
  expected << 0.0, -0.4, 0.0, 0.0,  //
      0.4, 0.0, 0.0, 0.0;
  EXPECT_LT((MountingJacobian({0.2, 0.1, 0.4}, {0.2, 0.1}) - expected).norm(), 1e-15);
}

TEST_F(MountingJacobianTest, ARaisedCameraSeesWiderAboutThePointUnderIt) {
  const Eigen::Vector4d raised(0.0, 0.0, 0.0, 0.01);
  const Eigen::Vector2d moved = MountingJacobian({0.2, 0.1, 0.4}, {0.5, -0.1}) * raised;
  EXPECT_NEAR(moved.x(), 0.003, 1e-15);
  EXPECT_NEAR(moved.y(), -0.002, 1e-15);
}

}  // namespace
}  // namespace floorloc
