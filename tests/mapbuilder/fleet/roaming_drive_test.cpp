// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/roaming_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mapbuilder/fleet/wheels_and_gyro.h"

namespace floorloc {
namespace {

constexpr double kCellM = 0.02;
constexpr double kViewM = 0.4;
constexpr double kStepS = 0.02;

// A floor of the shape of an L: 6 x 4 m without its upper right quarter.
cv::Mat SurveyedL() {
  cv::Mat surveyed(200, 300, CV_8UC1, cv::Scalar(255));
  surveyed(cv::Rect(150, 0, 150, 100)).setTo(0);
  return surveyed;
}

bool OnFloor(double x, double y) { return x >= 0.0 && y >= 0.0 && x <= 6.0 && y <= 4.0 && (x <= 3.0 || y <= 2.0); }

std::shared_ptr<const DrivableArea> AreaL() {
  return std::make_shared<const DrivableArea>(SurveyedL(), kCellM, kViewM);
}

TEST(DrivableAreaTest, AViewInsideIsOnTheFloorAtAnyHeading) {
  const auto area = AreaL();
  cv::RNG rng(1);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d p = area->RandomPoint(rng);
    ASSERT_TRUE(area->Contains(p));
    for (double angle = 0.0; angle < 6.3; angle += 0.1) {
      ASSERT_TRUE(OnFloor(p.x() + kViewM * std::cos(angle), p.y() + kViewM * std::sin(angle))) << p.transpose();
    }
  }
  EXPECT_TRUE(area->ContainsLine({0.5, 0.5}, {0.5, 3.5}));
  EXPECT_FALSE(area->ContainsLine({2.4, 3.5}, {5.5, 1.4})) << "across the corner";
  EXPECT_FALSE(area->Contains({5.0, 3.0}));
  EXPECT_FALSE(area->Contains({-1.0, 0.5}));
  EXPECT_NEAR(area->area_m2(), 5.2 * 1.2 + 2.2 * 2.0 + 0.0, 0.4);
}

TEST(DrivableAreaTest, OfSeveralPartsTheLargestIsDrivenOn) {
  cv::Mat surveyed(100, 300, CV_8UC1, cv::Scalar(255));
  surveyed(cv::Rect(100, 0, 10, 100)).setTo(0);
  const DrivableArea area(surveyed, kCellM, kViewM);
  EXPECT_FALSE(area.Contains({1.0, 1.0}));
  EXPECT_TRUE(area.Contains({4.0, 1.0}));
}

TEST(DrivableAreaTest, AFloorThatIsTooSmallIsRefused) {
  const cv::Mat surveyed(30, 30, CV_8UC1, cv::Scalar(255));
  EXPECT_THROW(DrivableArea(surveyed, kCellM, kViewM), std::invalid_argument);
}

struct DriveSpeeds {
  double speed_m_s;
};

class RoamingDriveTest : public testing::TestWithParam<DriveSpeeds> {};

TEST_P(RoamingDriveTest, StaysInsideWithinItsLimits) {
  DriveLimits limits;
  limits.speed_m_s = GetParam().speed_m_s;
  const auto area = AreaL();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RoamingDrive drive(area, limits, seed);
    double path_m = 0.0;
    cv::Rect2d visited(drive.map_from_base().x(), drive.map_from_base().y(), 1e-9, 1e-9);
    Eigen::Vector3d before = drive.twist();
    for (int i = 0; i < 6000; ++i) {
      const Pose2 from = drive.map_from_base();
      drive.Advance(kStepS);
      const Eigen::Vector3d twist = drive.twist();
      const Eigen::Vector2d here = drive.map_from_base().translation();
      ASSERT_TRUE(area->Contains(here)) << "seed " << seed << ", step " << i;
      ASSERT_LE(std::abs(twist.x()), limits.speed_m_s + 1e-9);
      ASSERT_LE(std::abs(twist.z()), limits.yaw_rate_rad_s + 1e-9);
      ASSERT_LE(std::abs(twist.x() - before.x()), limits.acceleration_m_s2 * kStepS + 1e-9);
      ASSERT_LE(std::abs(twist.z() - before.z()), limits.yaw_acceleration_rad_s2 * kStepS + 1e-9);
      ASSERT_LE(std::abs(twist.x() * twist.z()), 1.05 * limits.lateral_m_s2);
      ASSERT_LE((here - from.translation()).norm(), limits.speed_m_s * kStepS + 1e-9);
      path_m += twist.x() * kStepS;
      visited |= cv::Rect2d(here.x(), here.y(), 1e-9, 1e-9);
      before = twist;
    }
    EXPECT_GT(path_m, 0.4 * limits.speed_m_s * 120.0) << "it stands about, seed " << seed;
    EXPECT_GT(visited.area(), 4.0) << "it stays where it is, seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Speeds, RoamingDriveTest, testing::Values(DriveSpeeds{0.3}, DriveSpeeds{1.0}),
                         [](const auto& test) { return test.param.speed_m_s < 0.5 ? "slow" : "fast"; });

TEST(RoamingDriveTest, BrakesBeforeItIsCarried) {
  RoamingDrive drive(AreaL(), {}, 3);
  for (int i = 0; i < 500; ++i) {
    drive.Advance(kStepS);
  }
  ASSERT_FALSE(drive.stands());
  drive.Halt();
  int steps = 0;
  for (; !drive.stands(); ++steps) {
    ASSERT_LT(steps, 100);
    drive.Advance(kStepS);
  }
  EXPECT_GT(steps, 5);
  const Pose2 lifted = drive.map_from_base();
  drive.Carry();
  EXPECT_GT((drive.map_from_base().translation() - lifted.translation()).norm(), 0.05);
  const Pose2 put_down = drive.map_from_base();
  drive.Advance(kStepS);
  EXPECT_EQ(drive.map_from_base().x(), put_down.x()) << "it stands until it may drive";
  drive.Resume();
  drive.Advance(1.0 * kStepS);
  drive.Advance(1.0 * kStepS);
  EXPECT_FALSE(drive.stands());
}

TEST(WheelsAndGyroTest, DriftsAsRobotsDo) {
  double worst_rad = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RoamingDrive drive(AreaL(), {}, seed);
    WheelsAndGyro odometry({}, {}, seed);
    Pose2 measured = drive.map_from_base();
    for (int i = 0; i < 1500; ++i) {
      const Pose2 before = drive.map_from_base();
      drive.Advance(kStepS);
      measured = measured * Pose2::Exp(odometry.Measure(before.Between(drive.map_from_base()).Log(), kStepS));
    }
    const Pose2 error = drive.map_from_base().Between(measured);
    worst_rad = std::max(worst_rad, std::abs(error.yaw()));
    EXPECT_LT(error.translation().norm(), 0.3) << "within half a minute, seed " << seed;
    EXPECT_GT(error.translation().norm(), 1e-4);
  }
  EXPECT_LT(worst_rad, 0.03);
}

}  // namespace
}  // namespace floorloc
