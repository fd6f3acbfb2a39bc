// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_filter.h"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "core/evaluation/consistency.h"
#include "tests/core/fusion/drive_simulation.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

struct Sensors {
  bool wheels = true;
  bool imu = false;
  bool vision = false;
};

// A drive with all messages in order; the filter runs alongside the truth.
class Drive {
 public:
  Drive(std::uint32_t seed, const Sensors& sensors, const SensorErrors& errors = {},
        const PoseFilterOptions& options = {})
      : simulation(seed, errors), filter(options), sensors_(sensors) {
    filter.AddFix(simulation.Fix(kStartNs, truth));
  }

  // Runs to a time, with a fix every kFixNs unless with_fixes is false.
  void RunTo(double seconds, bool with_fixes = true) {
    for (const std::int64_t end = kStartNs + ToNs(seconds); now_ns < end;) {
      const std::int64_t next = now_ns + kImuNs;
      truth = truth * simulation.Motion(DriveSimulation::Seconds(now_ns), DriveSimulation::Seconds(next));
      now_ns = next;
      if (sensors_.imu) {
        filter.AddImu(simulation.Imu(now_ns));
      }
      if (sensors_.wheels && (now_ns - kStartNs) % kWheelNs == 0) {
        filter.AddIncrement(MotionSource::kWheels, simulation.Wheels(now_ns - kWheelNs, now_ns));
      }
      if ((now_ns - kStartNs) % kFixNs == 0) {
        if (sensors_.vision) {
          filter.AddIncrement(MotionSource::kVision, simulation.Vision(now_ns - kFixNs, now_ns));
        }
        if (with_fixes) {
          last_fix = filter.AddFix(simulation.Fix(now_ns, truth));
        }
      }
    }
  }

  double Nees() const {
    const FusedPose pose = *filter.Estimate();
    return floorloc::Nees(truth, pose.map_from_base, pose.covariance);
  }
  double ErrorM() const { return filter.Estimate()->map_from_base.Between(truth).translation().norm(); }

  DriveSimulation simulation;
  PoseFilter filter;
  Pose2 truth{1.0, 2.0, 0.7};
  std::int64_t now_ns = kStartNs;
  FixOutcome last_fix;

 private:
  Sensors sensors_;
};

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

// Compares all outputs of two filters.
void ExpectSame(const PoseFilter& a, const PoseFilter& b) {
  const FusedPose first = *a.Estimate();
  const FusedPose second = *b.Estimate();
  EXPECT_EQ(first.stamp_ns, second.stamp_ns);
  EXPECT_LT(first.map_from_base.Between(second.map_from_base).Log().norm(), 2e-6);
  EXPECT_LT(first.odom_from_base.Between(second.odom_from_base).Log().norm(), 2e-6);
  EXPECT_LT((first.covariance - second.covariance).norm(), 1e-3 * first.covariance.norm());
}

// Message i of a planar drive with wheel odometry and fixes.
struct Message {
  std::optional<MotionIncrement> wheels;
  std::optional<PoseFix> fix;
  void SendTo(PoseFilter* filter) const {
    if (wheels) {
      EXPECT_NE(filter->AddIncrement(MotionSource::kWheels, *wheels), MessageOutcome::kTooOld);
    }
    if (fix) {
      EXPECT_TRUE(filter->AddFix(*fix).accepted);
    }
  }
};

std::vector<Message> RecordDrive(double seconds) {
  DriveSimulation simulation(5);
  Pose2 truth;
  std::vector<Message> messages = {{std::nullopt, simulation.Fix(kStartNs, truth)}};
  for (std::int64_t t = kStartNs; t < kStartNs + ToNs(seconds); t += kWheelNs) {
    truth = truth * simulation.Motion(DriveSimulation::Seconds(t), DriveSimulation::Seconds(t + kWheelNs));
    messages.push_back({simulation.Wheels(t, t + kWheelNs), std::nullopt});
    if ((t + kWheelNs - kStartNs) % (2 * kFixNs) == 0) {
      messages.push_back({std::nullopt, simulation.Fix(t + kWheelNs, truth)});
    }
  }
  return messages;
}

TEST(PoseFilter, AppliesALateFixAtItsOwnTime) {
  const std::vector<Message> messages = RecordDrive(6.0);
  PoseFilter in_order, late;
  std::deque<Message> waiting;
  for (const Message& message : messages) {
    message.SendTo(&in_order);
    if (message.fix && late.Estimate()) {
      waiting.push_back(message);
    } else {
      message.SendTo(&late);
    }
    if (!waiting.empty() && message.wheels && message.wheels->to_ns >= waiting.front().fix->stamp_ns + ToNs(0.3)) {
      waiting.front().SendTo(&late);
      waiting.pop_front();
    }
  }
  for (const Message& message : waiting) {
    message.SendTo(&late);
  }
  ExpectSame(in_order, late);
}

TEST(PoseFilter, SortsLateIncrementsIn) {
  const std::vector<Message> messages = RecordDrive(4.0);
  PoseFilter in_order, shuffled;
  for (const Message& message : messages) {
    message.SendTo(&in_order);
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool swap = i % 7 == 3 && i + 1 < messages.size() && messages[i].wheels && messages[i + 1].wheels;
    messages[swap ? i + 1 : i].SendTo(&shuffled);
    if (swap) {
      messages[i++].SendTo(&shuffled);
    }
  }
  ExpectSame(in_order, shuffled);
}

TEST(PoseFilter, IgnoresDuplicates) {
  const std::vector<Message> messages = RecordDrive(2.0);
  PoseFilter once, twice;
  for (const Message& message : messages) {
    message.SendTo(&once);
    message.SendTo(&twice);
    if (message.wheels) {
      EXPECT_EQ(twice.AddIncrement(MotionSource::kWheels, *message.wheels), MessageOutcome::kDuplicate);
    } else {
      EXPECT_EQ(twice.AddFix(*message.fix).reason, FixRejection::kDuplicate);
    }
  }
  ExpectSame(once, twice);
}

TEST(PoseFilter, IgnoresWhatIsTooOldOrInvalid) {
  Drive drive(6, {});
  drive.RunTo(10.0);
  const Pose2 before = drive.filter.Estimate()->map_from_base;
  EXPECT_EQ(drive.filter.AddIncrement(MotionSource::kWheels, {kStartNs, kStartNs + 1, {}, {}}),
            MessageOutcome::kTooOld);
  EXPECT_EQ(drive.filter.AddFix(drive.simulation.Fix(kStartNs + 1, {})).reason, FixRejection::kTooOld);
  EXPECT_EQ(drive.filter.AddIncrement(MotionSource::kWheels, {drive.now_ns + 1, drive.now_ns, {}, {}}),
            MessageOutcome::kInvalid);
  EXPECT_EQ(drive.filter.AddIncrement(MotionSource::kWheels, {drive.now_ns, drive.now_ns + 1, Pose2(NAN, 0, 0), {}}),
            MessageOutcome::kInvalid);
  EXPECT_EQ(drive.filter.AddImu({drive.now_ns, NAN, {0, 0}}), MessageOutcome::kInvalid);
  PoseFix fix = drive.simulation.Fix(drive.now_ns + 1, drive.truth);
  fix.covariance(0, 0) = -1.0;
  EXPECT_EQ(drive.filter.AddFix(fix).reason, FixRejection::kInvalid);
  EXPECT_LT(before.Between(drive.filter.Estimate()->map_from_base).Log().norm(), 1e-9);
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

TEST(PoseFilter, GoesOnInTheNewTimeWhenTheClockWasSetBack) {
  Drive drive(7, {});
  drive.RunTo(10.0);
  const Pose2 before = drive.filter.Estimate()->map_from_base;
  const std::int64_t shift = ToNs(3600.0);
  std::vector<MessageOutcome> outcomes;
  std::int64_t t = drive.now_ns - shift;
  for (int i = 0; i < 6; ++i, t += kWheelNs) {
    outcomes.push_back(drive.filter.AddIncrement(MotionSource::kWheels, {t, t + kWheelNs, {}, {}}));
  }
  EXPECT_EQ(outcomes[3], MessageOutcome::kTooOld);
  EXPECT_EQ(outcomes[4], MessageOutcome::kClockJump);
  EXPECT_EQ(outcomes[5], MessageOutcome::kUsed);
  const FusedPose after = *drive.filter.Estimate();
  EXPECT_EQ(after.stamp_ns, t);
  EXPECT_LT(before.Between(after.map_from_base).Log().norm(), 1e-3);
  EXPECT_NE(after.state, TrackingState::kLocalized);
  EXPECT_TRUE(drive.filter.AddFix(drive.simulation.Fix(t, drive.truth)).accepted);
  EXPECT_EQ(drive.filter.Estimate()->state, TrackingState::kLocalized);
}

class Gates : public testing::Test {
 protected:
  Gates() { drive_.RunTo(5.0); }

  FixOutcome Send(const Pose2& offset, double p_wrong = 1e-9) {
    PoseFix fix = drive_.simulation.Fix(drive_.now_ns + ++sent_, drive_.truth * offset);
    fix.p_wrong = p_wrong;
    return drive_.filter.AddFix(fix);
  }

  Drive drive_{8, {}};
  int sent_ = 0;
};

TEST_F(Gates, EachHasItsReason) {
  EXPECT_EQ(Send({0, 0, 0}, 1e-3).reason, FixRejection::kWrongFixRisk);
  EXPECT_EQ(Send({0.21, 0, 0}).reason, FixRejection::kJumpDistance);
  EXPECT_EQ(Send({0, 0, 0.18}).reason, FixRejection::kJumpAngle);
  EXPECT_EQ(Send({0.02, 0, 0}).reason, FixRejection::kMahalanobis);
  EXPECT_TRUE(Send({0, 0, 0}).accepted);
}

TEST_F(Gates, AreThoseOfTheThesis) {
  EXPECT_NE(Send({0.19, 0, 0}).reason, FixRejection::kJumpDistance);
  EXPECT_NE(Send({0, 0, 9.5 * std::numbers::pi / 180}).reason, FixRejection::kJumpAngle);
  EXPECT_EQ(Send({0, 0, 10.5 * std::numbers::pi / 180}).reason, FixRejection::kJumpAngle);
}

TEST_F(Gates, WidenWhenTheVehicleMayBeFarOff) {
  drive_.RunTo(45.0, false);  // 16 m without a fix
  EXPECT_TRUE(Send({0, 0, 0}).accepted);
  EXPECT_GT(drive_.filter.AddFix(drive_.simulation.Fix(drive_.now_ns + 2, drive_.truth * Pose2(3, 0, 0))).distance_m,
            2.9);
}

TEST_F(Gates, ARejectedFixIsNoticed) {
  Send({0.5, 0, 0});
  EXPECT_EQ(drive_.filter.Estimate()->state, TrackingState::kTrackingOdometry);
  EXPECT_TRUE(drive_.filter.Estimate()->contradicted);
  EXPECT_TRUE(Send({0, 0, 0}).accepted);
  EXPECT_EQ(drive_.filter.Estimate()->state, TrackingState::kLocalized);
  EXPECT_FALSE(drive_.filter.Estimate()->contradicted);
}

TEST(PoseFilter, FindsAKidnappedVehicleAgain) {
  Drive drive(9, {});
  drive.RunTo(5.0);
  drive.truth = Pose2(-3.0, 1.0, 2.0);
  std::vector<FixOutcome> outcomes;
  std::vector<TrackingState> states;
  for (double t = 5.25; t < 6.1; t += 0.25) {
    drive.RunTo(t);
    outcomes.push_back(drive.last_fix);
    states.push_back(drive.filter.Estimate()->state);
  }
  EXPECT_EQ(states, (std::vector<TrackingState>{TrackingState::kTrackingOdometry, TrackingState::kLost,
                                                TrackingState::kLocalized, TrackingState::kLocalized}));
  EXPECT_EQ(outcomes[0].reason, FixRejection::kJumpDistance);
  EXPECT_EQ(outcomes[1].reason, FixRejection::kJumpDistance);
  EXPECT_TRUE(outcomes[2].accepted);
  EXPECT_TRUE(outcomes[2].reanchored);
  EXPECT_TRUE(outcomes[3].accepted);
  EXPECT_FALSE(outcomes[3].reanchored);
  EXPECT_LT(drive.ErrorM(), 0.003);
}

TEST(PoseFilter, WrongFixesThatDisagreeDoNotMoveIt) {
  Drive drive(10, {});
  drive.RunTo(5.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  for (int i = 0; i < 50; ++i) {
    drive.RunTo(5.0 + 0.02 * (i + 1), false);
    const FixOutcome outcome =
        drive.filter.AddFix(drive.simulation.Fix(drive.now_ns, Pose2(place(random), place(random), place(random))));
    EXPECT_FALSE(outcome.accepted);
  }
  EXPECT_LT(drive.ErrorM(), 0.02);
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
