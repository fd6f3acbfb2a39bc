// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/odometry_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/evaluation/consistency.h"
#include "core/fusion/pose_filter.h"
#include "tests/core/fusion/drive_simulation.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

using Change = std::function<MotionIncrement(MotionIncrement)>;

struct Answer {
  FixOutcome fix;
  FusedPose pose;
  double error_m = 0.0;
  double nees = 0.0;
};

// A drive whose wheels are changed from a time on, with a filter that runs along.
class FaultyDrive {
 public:
  FaultyDrive(double fix_s, Change change, double onset_s = 10.0)
      : fix_ns_(ToNs(fix_s)), onset_ns_(kStartNs + ToNs(onset_s)), change_(std::move(change)) {
    filter.AddFix(simulation.Fix(kStartNs, truth));
  }

  // The answers to the fixes until then. `spoil` changes fixes by their number.
  std::vector<Answer> RunTo(double seconds, const std::function<void(int, PoseFix*)>& spoil = {}) {
    std::vector<Answer> answers;
    while (now_ns < kStartNs + ToNs(seconds)) {
      const std::int64_t next = now_ns + kWheelNs;
      truth = truth * simulation.Motion(DriveSimulation::Seconds(now_ns), DriveSimulation::Seconds(next));
      const MotionIncrement right = simulation.Wheels(now_ns, next);
      const MotionIncrement said = next > onset_ns_ ? change_(right) : right;
      odom = odom * said.motion;
      filter.AddIncrement(MotionSource::kWheels, said);
      now_ns = next;
      if ((now_ns - kStartNs) % fix_ns_ == 0) {
        PoseFix fix = simulation.Fix(now_ns, truth);
        if (spoil) {
          spoil(++fixes_, &fix);
        }
        answers.push_back(Send(fix));
      }
    }
    return answers;
  }

  Answer Send(const PoseFix& fix) {
    Answer answer;
    answer.fix = filter.AddFix(fix);
    answer.pose = *filter.EstimateAt(fix.stamp_ns);
    answer.error_m = truth.Between(answer.pose.map_from_base).translation().norm();
    answer.nees = Nees(truth, answer.pose.map_from_base, answer.pose.covariance);
    return answer;
  }

  OdometryTrust Trust() const { return *filter.Estimate()->odometry; }

  DriveSimulation simulation{5};
  PoseFilter filter;
  Pose2 truth{1.0, 2.0, 0.7};
  Pose2 odom;
  std::int64_t now_ns = kStartNs;

 private:
  const std::int64_t fix_ns_;
  const std::int64_t onset_ns_;
  Change change_;
  int fixes_ = 0;
};

Change Twist(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& change) {
  return [change](MotionIncrement increment) {
    increment.motion = Pose2::Exp(change(increment.motion.Log()));
    return increment;
  };
}

Change Late(double seconds) {
  return [seconds](MotionIncrement increment) {
    increment.from_ns += ToNs(seconds);
    increment.to_ns += ToNs(seconds);
    return increment;
  };
}

MotionIncrement AsItIs(MotionIncrement increment) { return increment; }

struct Case {
  std::string name;
  OdometryFault fault = OdometryFault::kNone;
  Change change;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Faults : public testing::TestWithParam<std::tuple<Case, double>> {};

TEST_P(Faults, IsNamedAndOutvotedByFixes) {
  const auto& [c, fix_s] = GetParam();
  FaultyDrive drive(fix_s, c.change);
  drive.RunTo(10.0);
  EXPECT_EQ(drive.Trust().fault, OdometryFault::kNone);
  const std::vector<Answer> first = drive.RunTo(15.0);
  const std::vector<Answer> later = drive.RunTo(45.0);
  int good = 0;
  for (const Answer& answer : later) {
    good += answer.pose.state == TrackingState::kLocalized && answer.error_m < 0.01 ? 1 : 0;
  }
  EXPECT_GE(good, static_cast<int>(later.size()) - 1);
  EXPECT_EQ(drive.Trust().fault, c.fault);
  EXPECT_EQ(drive.Trust().health, OdometryHealth::kRejected);
  for (const Answer& answer : first) {
    EXPECT_LT(answer.nees, 30.0) << "refused fixes must show in the covariance";
  }
}

const Case kFaults[] = {
    {"reversed", OdometryFault::kReversed,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(-t.x(), -t.y(), t.z()); })},
    {"turned_left", OdometryFault::kAxesSwapped,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(-t.y(), t.x(), t.z()); })},
    {"turned_right", OdometryFault::kAxesSwapped,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(t.y(), -t.x(), t.z()); })},
    {"half", OdometryFault::kScale,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(0.5 * t.x(), 0.5 * t.y(), t.z()); })},
    {"twice", OdometryFault::kScale,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(2.0 * t.x(), 2.0 * t.y(), t.z()); })},
    {"mirrored", OdometryFault::kYawMirrored,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(t.x(), t.y(), -t.z()); })},
    {"degrees", OdometryFault::kYawInDegrees,
     Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(t.x(), t.y(), 180.0 / std::numbers::pi * t.z()); })},
    {"standing", OdometryFault::kStanding, Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(0.0 * t); })}};

INSTANTIATE_TEST_SUITE_P(OdometryMonitor, Faults,
                         testing::Combine(testing::ValuesIn(kFaults), testing::Values(0.2, 1.0)),
                         [](const auto& tested) {
                           return std::get<0>(tested.param).name +
                                  (std::get<1>(tested.param) < 0.5 ? "_often" : "_seldom");
                         });

TEST(OdometryMonitor, SaysHowLongRejectedDistancesAre) {
  FaultyDrive drive(1.0, kFaults[4].change);
  drive.RunTo(20.0);
  EXPECT_NEAR(drive.Trust().scale, 0.5, 0.02);
}

TEST(OdometryMonitor, WheelsAreTrustedAgainWhenTheyAreRight) {
  int increments = 0;
  FaultyDrive drive(0.2, [&increments](MotionIncrement increment) {
    increment.motion = ++increments < 400 ? Pose2() : increment.motion;  // for 8 s
    return increment;
  });
  drive.RunTo(15.0);
  EXPECT_EQ(drive.Trust().health, OdometryHealth::kRejected);
  drive.RunTo(25.0);
  EXPECT_EQ(drive.Trust().health, OdometryHealth::kOk);
  EXPECT_EQ(drive.Trust().fault, OdometryFault::kNone);
}

TEST(OdometryMonitor, RejectedWheelsStillMoveOdom) {
  FaultyDrive drive(0.2, kFaults[0].change);
  drive.RunTo(20.0);
  ASSERT_EQ(drive.Trust().health, OdometryHealth::kRejected);
  EXPECT_LT(drive.filter.Estimate()->odom_from_base.Between(drive.odom).translation().norm(), 1e-6);
}

TEST(OdometryMonitor, FindsWheelsThatAreStampedLateOrEarly) {
  for (const double late_s : {0.1, -0.2, 0.3}) {
    FaultyDrive drive(0.2, Late(late_s), 0.0);
    drive.RunTo(20.0);
    const std::vector<Answer> answers = drive.RunTo(40.0);
    // This drive's gentle curves tell shifts of 30 ms apart, not less.
    EXPECT_NEAR(drive.Trust().time_offset_s, late_s, 0.04);
    EXPECT_EQ(drive.Trust().health, OdometryHealth::kOk);
    EXPECT_EQ(drive.Trust().fault, OdometryFault::kTimeOffset);
    const auto refused = std::count_if(answers.begin(), answers.end(), [](const Answer& a) { return !a.fix.accepted; });
    EXPECT_LE(refused, 1) << late_s;
  }
}

TEST(OdometryMonitor, FindsNoOffsetWhereThereIsNone) {
  FaultyDrive drive(0.2, AsItIs);
  drive.RunTo(60.0);
  EXPECT_EQ(drive.Trust().time_offset_s, 0.0);
}

TEST(OdometryMonitor, LearnsSmallErrorsWithoutAWord) {
  FaultyDrive drive(
      0.5, Twist([](const Eigen::Vector3d& t) { return Eigen::Vector3d(t.x() / 1.05, t.y() / 1.05, t.z() / 0.97); }),
      0.0);
  drive.RunTo(60.0);
  EXPECT_EQ(drive.Trust().health, OdometryHealth::kOk);
  EXPECT_NEAR(drive.Trust().scale, 1.05, 0.005);
  EXPECT_NEAR(drive.Trust().yaw_scale, 0.97, 0.015);
}

// One in twenty fixes, in pairs that agree with each other, alternately by a tile's width and by metres.
TEST(OdometryMonitor, WrongFixesInPairsNeitherMoveThePoseNorAccuseTheWheels) {
  FaultyDrive drive(0.2, AsItIs);
  const auto is_wrong = [](int number) { return number % 40 == 20 || number % 40 == 21; };
  const std::vector<Answer> answers = drive.RunTo(80.0, [&](int number, PoseFix* fix) {
    if (is_wrong(number)) {
      fix->map_from_base = (number % 80 < 40 ? Pose2(0.3, 0.0, 0.0) : Pose2(-2.0, 1.0, 1.0)) * fix->map_from_base;
    }
  });
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].fix.accepted, !is_wrong(static_cast<int>(i) + 1)) << i;
    EXPECT_LT(answers[i].error_m, 0.01) << i;
  }
  EXPECT_EQ(drive.Trust().health, OdometryHealth::kOk);
}

// Successive fixes all contradict the wheels, but the right ones among them agree through them.
TEST(OdometryMonitor, EverySecondFixMayBeWrong) {
  FaultyDrive drive(0.5, AsItIs);
  const auto is_wrong = [](int number) { return number >= 30 && number < 40 && number % 2 == 0; };
  const std::vector<Answer> answers = drive.RunTo(30.0, [&](int number, PoseFix* fix) {
    if (is_wrong(number)) {
      fix->map_from_base = Pose2(0.3 + 0.05 * (number - 30), 0.1 * (number % 4), 0.0) * fix->map_from_base;
    }
  });
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].fix.accepted, !is_wrong(static_cast<int>(i) + 1)) << i;
    EXPECT_NE(answers[i].pose.odometry->health, OdometryHealth::kRejected) << i;
  }
}

TEST(Doubt, ARefusedFixShowsInTheCovarianceUntilOneAgrees) {
  FaultyDrive drive(0.2, AsItIs);
  drive.RunTo(5.0);
  const double sigma_before = drive.filter.Estimate()->covariance(0, 0);
  PoseFix wrong = drive.simulation.Fix(drive.now_ns + 1, drive.truth * Pose2(0.4, 0.0, 0.0));
  const Answer refused = drive.Send(wrong);
  EXPECT_FALSE(refused.fix.accepted);
  EXPECT_NEAR(std::sqrt(refused.pose.covariance(0, 0)), 0.4, 0.05);
  EXPECT_EQ(refused.pose.odometry->health, OdometryHealth::kSuspect);
  const Answer right = drive.Send(drive.simulation.Fix(drive.now_ns + 2, drive.truth));
  EXPECT_TRUE(right.fix.accepted);
  EXPECT_LT(right.pose.covariance(0, 0), 2.0 * sigma_before);
}

TEST(Doubt, ThreeRefusedFixesMakeAVehicleLostThoughTheyDisagree) {
  FaultyDrive drive(0.2, AsItIs);
  drive.RunTo(5.0);
  std::vector<TrackingState> states;
  for (const double x : {1.0, -2.0, 3.0}) {
    drive.now_ns += 1;
    states.push_back(drive.Send(drive.simulation.Fix(drive.now_ns, drive.truth * Pose2(x, 0.0, 0.0))).pose.state);
  }
  EXPECT_THAT(states, testing::ElementsAre(TrackingState::kTrackingOdometry, TrackingState::kTrackingOdometry,
                                           TrackingState::kLost));
}

}  // namespace
}  // namespace floorloc
