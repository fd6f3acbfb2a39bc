// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/motion_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <random>

namespace floorloc {
namespace {

class MotionCovarianceTest : public ::testing::Test {
 protected:
  Eigen::Vector3d Draw() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  // With a correlated covariance of millimetres and milliradians.
  AnchoredPose RandomPose() {
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    for (int column = 0; column < 3; ++column) {
      root.col(column) = 1e-3 * Draw();
    }
    return {Pose2(normal_(random_), normal_(random_), normal_(random_)), root * root.transpose()};
  }

  Pose2 Disturb(const AnchoredPose& pose) {
    const Eigen::Vector3d error = pose.covariance.llt().matrixL() * Draw();
    const Pose2& p = pose.anchor_from_base;
    return {p.x() + error.x(), p.y() + error.y(), p.yaw() + error.z()};
  }

  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
};

TEST_F(MotionCovarianceTest, IsHalfOfWhatIndependentPosesGive) {
  const AnchoredPose from = RandomPose();
  const AnchoredPose to = RandomPose();
  const Pose2 motion = from.anchor_from_base.Between(to.anchor_from_base);
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Pose2 drawn = Disturb(from).Between(Disturb(to));
    const Eigen::Vector3d error(drawn.x() - motion.x(), drawn.y() - motion.y(), drawn.yaw() - motion.yaw());
    sampled += error * error.transpose() / kDraws;
  }
  const Eigen::Matrix3d predicted = 2.0 * MotionCovariance(from, to);
  EXPECT_LT((sampled - predicted).norm(), 0.05 * predicted.norm());
}

TEST_F(MotionCovarianceTest, OfTheAnchorItselfIsThePosesCovariance) {
  const AnchoredPose to = RandomPose();
  EXPECT_TRUE(MotionCovariance({}, to).isApprox(to.covariance));
  EXPECT_TRUE(IncrementalCovariance({}, to).isApprox(to.covariance));
}

TEST_F(MotionCovarianceTest, AddedCovarianceAddsUpToAtLeastThePoses) {
  for (int trial = 0; trial < 100; ++trial) {
    const AnchoredPose from = RandomPose();
    const AnchoredPose to = RandomPose();
    const Eigen::Matrix3d added = IncrementalCovariance(from, to);
    const Pose2 motion = from.anchor_from_base.Between(to.anchor_from_base);
    const Eigen::Matrix3d excess = PropagatedCovariance(from, motion, added) - to.covariance;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(excess).eigenvalues().minCoeff(), -1e-12) << trial;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(added).eigenvalues().minCoeff(), -1e-12) << trial;
  }
}

TEST_F(MotionCovarianceTest, NothingIsAddedWhereNothingGotLessCertain) {
  AnchoredPose from = RandomPose();
  AnchoredPose to = from;
  from.covariance *= 2.0;
  EXPECT_LT(IncrementalCovariance(from, to).norm(), 1e-18);
}

}  // namespace
}  // namespace floorloc
