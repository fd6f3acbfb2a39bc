// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/learnt_odometry.h"

#include <gtest/gtest.h>

#include <tuple>

#include "core/fusion/pose_filter.h"
#include "core/fusion/simple_fuser.h"
#include "tests/core/fusion/drive_simulation.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

constexpr std::int64_t kLateNs = 100'000'000;
constexpr std::int64_t kFixEveryNs = 200'000'000;

// Wheels that measure 5 % too little and are stamped 0.1 s late.
class LearntOdometryTest : public testing::Test {
 protected:
  static SensorErrors ShortWheels() {
    SensorErrors errors;
    errors.wheels.scale = 0.05;
    return errors;
  }

  // factor: what the wheels' motion is multiplied with.
  void Drive(PoseFilter* filter, double seconds, double factor = 1.0) {
    const std::int64_t end_ns = now_ns_ + ToNs(seconds);
    while (now_ns_ < end_ns) {
      const std::int64_t next = now_ns_ + kWheelNs;
      truth_ = truth_ * simulation_.Motion(DriveSimulation::Seconds(now_ns_), DriveSimulation::Seconds(next));
      MotionIncrement wheels = simulation_.Wheels(now_ns_, next);
      wheels.motion = Pose2::Exp(factor * wheels.motion.Log());
      wheels.from_ns += kLateNs;
      wheels.to_ns += kLateNs;
      filter->AddIncrement(MotionSource::kWheels, wheels);
      now_ns_ = next;
      if ((now_ns_ - kStartNs) % kFixEveryNs == 0) {
        filter->AddFix(simulation_.Fix(now_ns_, truth_));
      }
    }
  }

  DriveSimulation simulation_{5, ShortWheels()};
  Pose2 truth_{1.0, 2.0, 0.7};
  std::int64_t now_ns_ = kStartNs;
};

TEST_F(LearntOdometryTest, AnotherFilterGoesOnWithIt) {
  PoseFilter first;
  EXPECT_FALSE(first.Learnt());
  Drive(&first, 60.0);
  const std::optional<LearntOdometry> learnt = first.Learnt();
  ASSERT_TRUE(learnt);
  EXPECT_NEAR(learnt->bias.scale, 0.05, 0.01);
  EXPECT_NEAR(1e-9 * static_cast<double>(learnt->offset_ns), 0.1, 0.04);

  PoseFilter fresh, resumed;
  resumed.Resume(*learnt);
  EXPECT_EQ(resumed.Learnt()->bias.scale, learnt->bias.scale) << "what was not used yet is not lost";
  const auto before = std::tuple(simulation_, truth_, now_ns_);
  Drive(&fresh, 0.5);
  std::tie(simulation_, truth_, now_ns_) = before;
  Drive(&resumed, 0.5);
  EXPECT_LT(fresh.Estimate()->odometry->scale, 1.035);
  EXPECT_NEAR(resumed.Estimate()->odometry->scale, 1.05, 0.01);
  EXPECT_EQ(fresh.Estimate()->odometry->time_offset_s, 0.0);
  EXPECT_NEAR(resumed.Estimate()->odometry->time_offset_s, 0.1, 0.04);
  EXPECT_EQ(resumed.Estimate()->odometry->health, OdometryHealth::kLearning) << "the new drive did not confirm it yet";
  EXPECT_LT(resumed.State()->covariance(error_row::kOdometryScale, error_row::kOdometryScale),
            0.5 * fresh.State()->covariance(error_row::kOdometryScale, error_row::kOdometryScale));
}

TEST_F(LearntOdometryTest, WheelsThatAreRejectedTaughtNothing) {
  PoseFilter filter;
  Drive(&filter, 20.0);
  EXPECT_TRUE(filter.Learnt());
  Drive(&filter, 20.0, -1.0);
  EXPECT_EQ(filter.Estimate()->odometry->health, OdometryHealth::kRejected);
  EXPECT_FALSE(filter.Learnt());
}

TEST_F(LearntOdometryTest, SimpleFusersLearnNothing) {
  const auto fuser = MakePoseFuser(FusionMethod::kReplace, {});
  fuser->Resume({});
  EXPECT_FALSE(fuser->Learnt());
}

}  // namespace
}  // namespace floorloc
