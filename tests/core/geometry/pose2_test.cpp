// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSeed = 20;
constexpr int kRounds = 1000;

// Random poses, half of them with tiny or extreme angles, where closed forms lose precision.
class Pose2Laws : public ::testing::Test {
 protected:
  Pose2 RandomPose() { return {Uniform(-100, 100), Uniform(-100, 100), RandomAngle()}; }
  Eigen::Vector2d RandomPoint() { return {Uniform(-10, 10), Uniform(-10, 10)}; }
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  double RandomAngle() {
    switch (std::uniform_int_distribution<int>(0, 3)(rng_)) {
      case 0:
        return std::pow(10.0, Uniform(-12, -2));
      case 1:
        return kPi - std::pow(10.0, Uniform(-12, -2));
      default:
        return Uniform(-kPi, kPi);
    }
  }

 private:
  std::mt19937_64 rng_{kSeed};
};

void ExpectNear(const Pose2& a, const Pose2& b, double tolerance = 1e-9) {
  EXPECT_NEAR(a.x(), b.x(), tolerance);
  EXPECT_NEAR(a.y(), b.y(), tolerance);
  EXPECT_NEAR(WrapAngle(a.yaw() - b.yaw()), 0.0, tolerance);
}

TEST_F(Pose2Laws, IdentityIsNeutral) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    ExpectNear(a * Pose2(), a);
    ExpectNear(Pose2() * a, a);
  }
}

TEST_F(Pose2Laws, CompositionIsAssociative) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Pose2 b = RandomPose();
    const Pose2 c = RandomPose();
    ExpectNear((a * b) * c, a * (b * c));
  }
}

TEST_F(Pose2Laws, InverseUndoes) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    ExpectNear(a * a.Inverse(), Pose2());
    ExpectNear(a.Inverse() * a, Pose2());
    ExpectNear(a.Inverse().Inverse(), a);
  }
}

TEST_F(Pose2Laws, InverseOfAProductIsTheProductOfInversesInReverse) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Pose2 b = RandomPose();
    ExpectNear((a * b).Inverse(), b.Inverse() * a.Inverse());
  }
}

TEST_F(Pose2Laws, ActionOnPointsAgreesWithComposition) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Pose2 b = RandomPose();
    const Eigen::Vector2d p = RandomPoint();
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-9);
    EXPECT_LT((a * p - (a.rotation() * p + a.translation())).norm(), 1e-12);
  }
}

TEST_F(Pose2Laws, BetweenLeadsFromOneToTheOther) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Pose2 b = RandomPose();
    ExpectNear(a * a.Between(b), b);
  }
}

TEST_F(Pose2Laws, ExpUndoesLog) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    ExpectNear(Pose2::Exp(a.Log()), a);
  }
}

TEST_F(Pose2Laws, LogUndoesExp) {
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector3d twist(Uniform(-10, 10), Uniform(-10, 10), RandomAngle());
    EXPECT_LT((Pose2::Exp(twist).Log() - twist).norm(), 1e-9);
  }
}

TEST_F(Pose2Laws, ExpIsAOneParameterSubgroup) {
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector3d twist(Uniform(-10, 10), Uniform(-10, 10), Uniform(-2, 2));
    const double s = Uniform(-1, 1);
    const double t = Uniform(-1, 1);
    ExpectNear(Pose2::Exp(s * twist) * Pose2::Exp(t * twist), Pose2::Exp((s + t) * twist));
  }
}

TEST_F(Pose2Laws, ExpIsContinuousWhereItSwitchesToTheSeries) {
  const Eigen::Vector2d velocity(3, -7);
  for (const double omega : {1e-4 * (1 - 1e-9), 1e-4 * (1 + 1e-9), -1e-4 * (1 - 1e-9), -1e-4 * (1 + 1e-9)}) {
    // The exact motion along an arc by half-angle formulas, which do not divide by a small angle squared.
    const double half = omega / 2;
    const double chord = std::sin(half) / half;
    const Eigen::Vector2d expected = Pose2(0, 0, half) * Eigen::Vector2d(chord * velocity);
    const Pose2 moved = Pose2::Exp({velocity.x(), velocity.y(), omega});
    EXPECT_LT((moved.translation() - expected).norm(), 1e-11) << "omega " << omega;
  }
}

TEST_F(Pose2Laws, AdjointMovesATwistToTheOtherSide) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Eigen::Vector3d twist(Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1));
    ExpectNear(a * Pose2::Exp(twist), Pose2::Exp(a.Adjoint() * twist) * a);
  }
}

TEST_F(Pose2Laws, AdjointIsAHomomorphism) {
  for (int i = 0; i < kRounds; ++i) {
    const Pose2 a = RandomPose();
    const Pose2 b = RandomPose();
    EXPECT_LT(((a * b).Adjoint() - a.Adjoint() * b.Adjoint()).norm(), 1e-9);
  }
}

TEST_F(Pose2Laws, RotationIsProper) {
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Matrix2d r = RandomPose().rotation();
    EXPECT_LT((r * r.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(r.determinant(), 1.0, 1e-12);
  }
}

TEST_F(Pose2Laws, WrapAngleStaysInItsRangeAndKeepsTheAngle) {
  for (int i = 0; i < kRounds; ++i) {
    const double angle = Uniform(-1000, 1000);
    const double wrapped = WrapAngle(angle);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-10);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-10);
  }
}

TEST(WrapAngle, HalfATurnIsPositive) {
  EXPECT_DOUBLE_EQ(WrapAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(3 * kPi), kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(0), 0);
  EXPECT_TRUE(std::isnan(WrapAngle(std::numeric_limits<double>::infinity())));
}

TEST(Pose2, QuarterTurnMapsForwardToLeft) {
  const Eigen::Vector2d p = Pose2(1, 2, kPi / 2) * Eigen::Vector2d(3, 0);
  EXPECT_NEAR(p.x(), 1, 1e-12);
  EXPECT_NEAR(p.y(), 5, 1e-12);
}

TEST(Pose2, IsFiniteLooksAtEveryNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(Pose2(1, 2, 3).IsFinite());
  EXPECT_FALSE(Pose2(nan, 2, 3).IsFinite());
  EXPECT_FALSE(Pose2(1, nan, 3).IsFinite());
  EXPECT_FALSE(Pose2(1, 2, std::numeric_limits<double>::infinity()).IsFinite());
}

}  // namespace
}  // namespace floorloc
