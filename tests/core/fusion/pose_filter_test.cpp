// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_filter.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/evaluation/consistency.h"
#include "tests/core/fusion/filtered_drive.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

SensorErrors DrawErrors(std::uint32_t seed, const PoseFilterOptions& options) {
  std::mt19937 random(seed);
  const auto draw = [&](double sigma) { return std::normal_distribution<double>(0.0, 1.0)(random) * sigma; };
  SensorErrors errors;
  errors.wheels = {draw(options.odometry.scale), draw(options.odometry.yaw_scale),
                   draw(options.odometry.drift_rad_per_m)};
  errors.imu.yaw_rate_rad_s = draw(options.imu.gyro_bias);
  errors.imu.acceleration_m_s2 = {draw(options.imu.accelerometer_bias), draw(options.imu.accelerometer_bias)};
  return errors;
}

// Mean NEES over many drives: with fixes, and two seconds after the last fix.
class Consistency : public testing::TestWithParam<Sensors> {};

TEST_P(Consistency, CovarianceIsHonest) {
  std::vector<double> with_fixes, without;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Drive drive(seed, GetParam(), DrawErrors(1000 + seed, {}));
    drive.RunTo(10.0);
    with_fixes.push_back(drive.Nees());
    drive.RunTo(12.0, false);
    without.push_back(drive.Nees());
  }
  // The filter models errors that the simulation lacks (vibration, slopes, wheel slip in turns), so it may be
  // underconfident, but never overconfident.
  for (const auto& values : {with_fixes, without}) {
    const NeesSummary nees = SummarizeNees(values);
    EXPECT_LT(nees.mean, nees.upper);
    EXPECT_GT(nees.mean, 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(PoseFilter, Consistency,
                         testing::Values(Sensors{true, false, false}, Sensors{true, true, false},
                                         Sensors{false, false, true}, Sensors{true, true, true},
                                         Sensors{false, true, false}));

TEST(PoseFilter, LearnsWhatTheWheelsDoWrong) {
  SensorErrors errors;
  errors.wheels = {0.03, -0.03, 0.008};
  Drive drive(1, {}, errors);
  drive.RunTo(60.0);
  const OdometryBias found = drive.filter.State()->odometry_bias;
  EXPECT_NEAR(found.scale, errors.wheels.scale, 0.003);
  EXPECT_NEAR(found.yaw_scale, errors.wheels.yaw_scale, 0.01);
  EXPECT_NEAR(found.drift_rad_per_m, errors.wheels.drift_rad_per_m, 0.003);
  drive.RunTo(70.0, false);
  EXPECT_LT(drive.ErrorM(), 0.04);  // over 4 m without a fix; at least 0.12 m with uncorrected errors
}

TEST(PoseFilter, LearnsTheBiasesOfTheImu) {
  SensorErrors errors;
  errors.imu = {0.03, {0.15, -0.1}};
  Drive drive(2, {true, true, false}, errors);
  drive.RunTo(30.0);
  const ImuBias found = drive.filter.State()->imu_bias;
  EXPECT_NEAR(found.yaw_rate_rad_s, 0.03, 1.5e-3);
  EXPECT_NEAR(found.acceleration_m_s2.x(), 0.15, 0.05);
  EXPECT_NEAR(found.acceleration_m_s2.y(), -0.1, 0.05);
}

TEST(PoseFilter, LearnsTheScaleOfTheCamera) {
  PoseFilterOptions options;
  options.vision.scale = 0.02;
  Drive drive(18, {}, {}, options);
  for (int i = 1; i <= 200; ++i) {
    const std::int64_t from = drive.now_ns;
    drive.RunTo(0.25 * i);
    MotionIncrement increment = drive.simulation.Vision(from, drive.now_ns);
    increment.motion = Pose2(0.98 * increment.motion.x(), 0.98 * increment.motion.y(), increment.motion.yaw());
    drive.filter.AddIncrement(MotionSource::kVision, increment);
  }
  EXPECT_NEAR(drive.filter.State()->vision_scale, 0.02, 0.006);
}

TEST(PoseFilter, BridgesAHoleInTheOdometryByTheImu) {
  Drive with_imu(3, {true, true, false});
  Drive blind(3, {true, false, false});
  for (Drive* drive : {&with_imu, &blind}) {
    drive->RunTo(10.0);
  }
  // Half a second of IMU messages only.
  for (std::int64_t t = with_imu.now_ns; t < with_imu.now_ns + ToNs(0.5); t += kImuNs) {
    with_imu.filter.AddImu(with_imu.simulation.Imu(t + kImuNs));
  }
  const Pose2 truth = with_imu.truth * with_imu.simulation.Motion(10.0, 10.5);
  const FusedPose bridged = *with_imu.filter.Estimate();
  EXPECT_LT(bridged.map_from_base.Between(truth).translation().norm(), 0.01);
  EXPECT_LT(Nees(truth, bridged.map_from_base, bridged.covariance), 16.3);
  EXPECT_GT(blind.filter.EstimateAt(blind.now_ns + ToNs(0.5))->covariance(2, 2), 10 * bridged.covariance(2, 2));
}

// The vehicle stops within 0.2 s while its wheels keep turning.
TEST(PoseFilter, TrustsVisionWhenTheWheelsSlip) {
  Drive drive(16, {true, false, true});
  drive.RunTo(10.0);
  const double speed = drive.simulation.Speed(10.0);
  const Pose2 braking(0.1 * speed, 0, 0);
  drive.truth = drive.truth * braking;
  for (int i = 0; i < 25; ++i) {
    const std::int64_t t = drive.now_ns + i * kWheelNs;
    drive.filter.AddIncrement(MotionSource::kWheels, {t, t + kWheelNs, Pose2(0.02 * speed, 0, 0), {}});
  }
  const std::int64_t end = drive.now_ns + 25 * kWheelNs;
  EXPECT_GT(drive.ErrorM(), 0.15);
  drive.filter.AddIncrement(MotionSource::kVision, {drive.now_ns, end, braking, drive.simulation.FixCovariance()});
  EXPECT_LT(drive.ErrorM(), 0.005);
  EXPECT_TRUE(drive.filter.AddFix(drive.simulation.Fix(end, drive.truth)).accepted);
}

// The gyro measures a rotation by 20 degrees, while the wheels measure straight motion.
TEST(PoseFilter, GrowsUncertainWhenGyroAndWheelsContradict) {
  Drive drive(16, {true, true, false});
  drive.RunTo(10.0);
  const double sigma_before = std::sqrt(drive.filter.Estimate()->covariance(2, 2));
  for (int i = 0; i < 25; ++i) {
    const std::int64_t t = drive.now_ns + i * kWheelNs;
    drive.filter.AddIncrement(MotionSource::kWheels, {t, t + kWheelNs, Pose2(0.008, 0, 0), {}});
    drive.filter.AddImu({t + kImuNs, i < 10 ? 1.7 : 0.0, {0.0, 0.0}});
    drive.filter.AddImu({t + kWheelNs, i < 10 ? 1.7 : 0.0, {0.0, 0.0}});
  }
  drive.truth = drive.truth * Pose2(0.2, 0, 0);
  const FusedPose pose = *drive.filter.Estimate();
  EXPECT_LT(std::abs(WrapAngle(pose.map_from_base.yaw() - drive.truth.yaw())), 0.02);
  EXPECT_GT(std::sqrt(pose.covariance(2, 2)), 0.1);
  EXPECT_LT(sigma_before, 0.002);
  EXPECT_TRUE(drive.filter.AddFix(drive.simulation.Fix(pose.stamp_ns, drive.truth)).accepted);
  EXPECT_LT(drive.ErrorM(), 0.003);
}

TEST(PoseFilter, AKnockDoesNotSpoilTheVelocity) {
  Drive drive(19, {true, true, false});
  drive.RunTo(10.0);
  for (std::int64_t end = drive.now_ns + ToNs(0.4); drive.now_ns < end; drive.now_ns += kWheelNs) {
    drive.filter.AddIncrement(MotionSource::kWheels, drive.simulation.Wheels(drive.now_ns, drive.now_ns + kWheelNs));
    for (const std::int64_t t : {drive.now_ns + kImuNs, drive.now_ns + kWheelNs}) {
      ImuReading reading = drive.simulation.Imu(t);
      reading.acceleration_m_s2.x() += t < end - ToNs(0.2) ? 20.0 : 0.0;
      drive.filter.AddImu(reading);
    }
  }
  EXPECT_LT((drive.filter.State()->velocity_m_s - Eigen::Vector2d(drive.simulation.Speed(10.4), 0)).norm(), 0.1);
}

TEST(PoseFilter, AdaptsToWheelsThatAreWorseThanThought) {
  SensorErrors errors;
  errors.wheel_noise_m = 0.02;
  errors.wheel_noise_rad = 0.04;
  Drive drive(17, {}, errors);
  drive.RunTo(30.0);
  EXPECT_GT(drive.filter.State()->wheel_noise_factor, 5.0);
  int rejected = 0;
  std::vector<double> nees;
  for (double t = 30.25; t < 60.0; t += 0.25) {
    drive.RunTo(t - 0.02, false);
    nees.push_back(drive.Nees());
    drive.RunTo(t);
    rejected += drive.last_fix.accepted ? 0 : 1;
  }
  EXPECT_EQ(rejected, 0);
  EXPECT_LT(SummarizeNees(nees).mean, 4.5);
}

TEST(PoseFilter, OdomNeverJumps) {
  Drive drive(11, {true, true, false});
  Pose2 odom = drive.filter.Estimate()->odom_from_base;
  for (int i = 1; i <= 100; ++i) {
    if (i == 50) {
      drive.truth = Pose2(5.0, 5.0, 1.0);  // kidnapped
    }
    drive.RunTo(0.1 * i);
    const FusedPose pose = *drive.filter.Estimate();
    EXPECT_LT(odom.Between(pose.odom_from_base).translation().norm(), 0.08);
    EXPECT_LT((pose.map_from_odom * pose.odom_from_base).Between(pose.map_from_base).Log().norm(), 1e-12);
    odom = pose.odom_from_base;
  }
}

TEST(PoseFilter, SaysWhenItIsLost) {
  PoseFilter filter;
  EXPECT_FALSE(filter.Estimate().has_value());
  DriveSimulation simulation(12);
  filter.AddIncrement(MotionSource::kWheels, simulation.Wheels(kStartNs, kStartNs + kWheelNs));
  EXPECT_FALSE(filter.Estimate().has_value());
  EXPECT_TRUE(filter.AddFix(simulation.Fix(kStartNs + kWheelNs, {})).first);
  EXPECT_EQ(filter.Estimate()->state, TrackingState::kLocalized);
  filter.AddUnlocalizedFrame(kStartNs + 2 * kWheelNs);
  EXPECT_EQ(filter.Estimate()->state, TrackingState::kTrackingOdometry);
  EXPECT_EQ(filter.EstimateAt(kStartNs + ToNs(5.0))->state, TrackingState::kLost);  // its motion was not measured
}

TEST(PoseFilter, CountsSinceTheLastFix) {
  Drive drive(13, {});
  drive.RunTo(5.0);
  EXPECT_EQ(drive.filter.Estimate()->since_fix->seconds, 0.0);
  drive.RunTo(7.0, false);
  const SinceFix since = *drive.filter.Estimate()->since_fix;
  EXPECT_NEAR(since.seconds, 2.0, 1e-9);
  EXPECT_NEAR(since.metres, drive.simulation.Motion(5.0, 7.0).translation().norm(), 0.05);
}

TEST(PoseFilter, TakesAPoseByHand) {
  Drive drive(14, {});
  drive.RunTo(5.0);
  PoseFix hand{drive.now_ns, Pose2(10, 10, 0), Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal(), 0.0};
  drive.filter.SetPose(hand);
  const FusedPose pose = *drive.filter.Estimate();
  EXPECT_EQ(pose.state, TrackingState::kTrackingOdometry);
  EXPECT_NEAR(pose.map_from_base.x(), 10.0, 1e-9);
  EXPECT_FALSE(pose.since_fix.has_value());
  EXPECT_TRUE(drive.filter.AddFix(drive.simulation.Fix(drive.now_ns, Pose2(10.1, 10, 0.05))).accepted);
}

// All fixes at one place share the map's error there, which averaging cannot reduce.
TEST(PoseFilter, StandingStillNeitherDriftsNorBecomesTooSure) {
  std::vector<double> nees;
  SensorErrors errors;
  errors.fix_sigma_m = 1e-4;
  errors.fix_sigma_rad = 1.5e-4;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    DriveSimulation simulation(seed, errors);
    const Pose2 off_by(simulation.Normal(2e-4), simulation.Normal(2e-4), simulation.Normal(3e-4));
    PoseFilter filter;
    for (int i = 0; i < 100; ++i) {
      const std::int64_t t = kStartNs + i * kFixNs;
      if (i > 0) {
        filter.AddIncrement(MotionSource::kWheels, {t - kFixNs, t, {}, {}});
      }
      EXPECT_TRUE(filter.AddFix(simulation.Fix(t, off_by)).accepted);
    }
    nees.push_back(Nees({}, filter.Estimate()->map_from_base, filter.Estimate()->covariance));
  }
  EXPECT_LT(SummarizeNees(nees).mean, SummarizeNees(nees).upper);
}

TEST(PoseFilter, RefusesOptionsThatMakeNoSense) {
  PoseFilterOptions options;
  options.gates.max_distance_m = 0.0;
  EXPECT_THROW(PoseFilter{options}, std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
