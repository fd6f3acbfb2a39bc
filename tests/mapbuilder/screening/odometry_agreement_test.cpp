// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "mapbuilder/screening/odometry_reading.h"

namespace floorloc {
namespace {

// Motions of a robot on a weaving path, and the visual measurements of them.
std::vector<MotionPair> Motions(double scale, double direction_rad, double mirror) {
  cv::RNG rng(7);
  std::vector<MotionPair> motions;
  for (int i = 0; i < 40; ++i) {
    const double turn = rng.uniform(-0.1, 0.1);
    const Pose2 odometry = Pose2::Exp({rng.uniform(0.05, 0.2), 0.0, turn});
    const Eigen::Vector2d vision_yaw =
        Pose2(0.0, 0.0, direction_rad) * (scale * Eigen::Vector2d(odometry.x(), mirror * odometry.y()));
    motions.push_back(
        {odometry, Pose2(vision_yaw.x() + rng.gaussian(5e-4), vision_yaw.y() + rng.gaussian(5e-4), mirror * turn)});
  }
  return motions;
}

TEST(CompareMotions, FindsScaleAndDirection) {
  const MotionAgreement agreement = CompareMotions(Motions(1.2, -0.4, 1.0));
  EXPECT_EQ(agreement.motions, 40);
  EXPECT_NEAR(agreement.scale, 1.2, 0.01);
  EXPECT_NEAR(agreement.direction_rad, -0.4, 0.01);
  EXPECT_LT(agreement.scatter, 0.02);
  EXPECT_EQ(agreement.reading, OdometryReading::kAsSaid);
}

TEST(CompareMotions, AThirdOfWrongMotionsDoesNotCount) {
  std::vector<MotionPair> motions = Motions(1.0, 0.0, 1.0);
  for (std::size_t i = 0; i < motions.size(); i += 3) {
    motions[i].by_vision = Pose2(0.4, -0.3, -1.0);
  }
  const MotionAgreement agreement = CompareMotions(motions);
  EXPECT_NEAR(agreement.scale, 1.0, 0.02);
  EXPECT_NEAR(agreement.direction_rad, 0.0, 0.02);
  EXPECT_EQ(agreement.reading, OdometryReading::kAsSaid);
}

TEST(CompareMotions, TurnsRevealAMirroredHomography) {
  EXPECT_EQ(CompareMotions(Motions(1.0, 0.0, -1.0)).reading, OdometryReading::kMirrored);
  EXPECT_EQ(CompareMotions(Motions(1.0, 2.0, -1.0)).reading, OdometryReading::kMirrored);
}

TEST(CompareMotions, WithoutTurnsSidewaysMotionRevealsAMirroredHomography) {
  std::vector<MotionPair> motions;
  for (int i = 0; i < 20; ++i) {
    const Pose2 odometry = i % 2 == 0 ? Pose2(0.1, 0.0, 0.0) : Pose2(0.02, i % 4 == 1 ? 0.1 : -0.1, 3.1);
    motions.push_back({odometry, Pose2(odometry.x(), -odometry.y(), -odometry.yaw())});
  }
  EXPECT_EQ(CompareMotions(motions).reading, OdometryReading::kMirrored);
  for (MotionPair& m : motions) {
    m.by_vision = m.by_odometry;
  }
  EXPECT_EQ(CompareMotions(motions).reading, OdometryReading::kAsSaid);
}

TEST(CompareMotions, FewMotionsSayNothing) {
  std::vector<MotionPair> motions = Motions(2.0, 0.0, 1.0);
  motions.resize(4);
  EXPECT_EQ(CompareMotions(motions).motions, 0);
}

TEST(CompareMotions, OdometryOfAnotherTimeScatters) {
  std::vector<MotionPair> motions = Motions(1.0, 0.0, 1.0);
  for (std::size_t i = 0; i + 1 < motions.size(); ++i) {
    motions[i].by_vision = motions[i + 1].by_vision;
  }
  EXPECT_GT(CompareMotions(motions).scatter, 0.2);
}

}  // namespace
}  // namespace floorloc
