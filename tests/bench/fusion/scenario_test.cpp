// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/scenario.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/fusion/replay.h"

namespace floorloc {
namespace {

constexpr std::int64_t kWheelNs = 20'000'000;
constexpr std::int64_t kFixNs = 200'000'000;

// 100 s along x at 0.3 m/s, odometry at 50 Hz, 5 fixes per second, all exact.
FusionRecording StraightDrive() {
  FusionRecording recording;
  for (std::int64_t stamp_ns = 0; stamp_ns <= 100'000'000'000; stamp_ns += kWheelNs) {
    const Pose2 pose(0.3e-9 * static_cast<double>(stamp_ns), 0.0, 0.0);
    recording.odometry.push_back(StampedPose3::FromPose2(stamp_ns, pose));
    recording.truth.push_back(StampedPose3::FromPose2(stamp_ns, pose));
    if (stamp_ns % kFixNs == 0) {
      const Eigen::Matrix3d covariance = 1e-6 * Eigen::Matrix3d::Identity();
      recording.images.push_back({stamp_ns, PoseFix{stamp_ns, pose, covariance, 1e-9}, std::nullopt});
      if (stamp_ns > 0) {
        recording.images.back().motion =
            MotionIncrement{stamp_ns - kFixNs, stamp_ns, Pose2(0.06, 0.0, 0.0), covariance};
      }
    }
  }
  return recording;
}

std::vector<PoseFix> FixesIn(const std::vector<FusionMessage>& messages) {
  std::vector<PoseFix> fixes;
  for (const FusionMessage& message : messages) {
    if (const auto* fix = std::get_if<PoseFix>(&message.content)) {
      fixes.push_back(*fix);
    }
  }
  return fixes;
}

bool IsWheels(const MotionMessage* motion) { return motion != nullptr && motion->source == MotionSource::kWheels; }

bool IsWrong(const PoseFix& fix) {
  const Pose2 truth(0.3e-9 * static_cast<double>(fix.stamp_ns), 0.0, 0.0);
  return truth.Between(fix.map_from_base).Log().norm() > 1e-6;
}

TEST(FusionScenario, WithoutChangesReplaysTheRecording) {
  const FusionRecording recording = StraightDrive();
  const std::vector<FusionMessage> messages = MakeMessages(recording, {}, 1);
  EXPECT_EQ(messages.size(), 5000U + 501U + 500U);
  EXPECT_TRUE(std::is_sorted(messages.begin(), messages.end(),
                             [](const auto& a, const auto& b) { return a.arrival_ns < b.arrival_ns; }));
  const std::vector<PoseFix> fixes = FixesIn(messages);
  EXPECT_TRUE(std::none_of(fixes.begin(), fixes.end(), IsWrong));
}

TEST(FusionScenario, DropsFixesAndHasAnOutage) {
  const std::vector<PoseFix> fixes = FixesIn(MakeMessages(StraightDrive(), {.drop_rate = 0.4, .outage_s = 20.0}, 1));
  EXPECT_NEAR(static_cast<double>(fixes.size()), 0.6 * 400.0, 40.0);
  EXPECT_TRUE(std::none_of(fixes.begin(), fixes.end(),
                           [](const PoseFix& fix) { return std::abs(1e-9 * double(fix.stamp_ns) - 50.0) < 9.9; }));
}

TEST(FusionScenario, MakesFixesWrongAloneOrInRuns) {
  for (const int run : {1, 4}) {
    const std::vector<PoseFix> fixes = FixesIn(MakeMessages(StraightDrive(), {.wrong_rate = 0.1, .wrong_run = run}, 3));
    EXPECT_NEAR(static_cast<double>(std::count_if(fixes.begin(), fixes.end(), IsWrong)), 50.0, 25.0);
    EXPECT_TRUE(std::none_of(fixes.begin(), fixes.begin() + 5, IsWrong));
    const auto first = std::find_if(fixes.begin(), fixes.end(), IsWrong);
    const double motion_m = first->map_from_base.Between((first + 1)->map_from_base).translation().norm();
    EXPECT_EQ(std::abs(motion_m - 0.06) < 1e-9, run > 1);  // within a run the fixes move as the robot does
  }
}

TEST(FusionScenario, DelaysFixesButNotTheirStamps) {
  for (const FusionMessage& message : MakeMessages(StraightDrive(), {.latency_s = 0.4}, 1)) {
    if (const auto* fix = std::get_if<PoseFix>(&message.content)) {
      EXPECT_GE(message.arrival_ns - fix->stamp_ns, 200'000'000);
      EXPECT_LE(message.arrival_ns - fix->stamp_ns, 600'000'000);
      EXPECT_FALSE(IsWrong(*fix));
    }
  }
}

TEST(FusionScenario, StretchesAndBendsOdometry) {
  const FusionScenario scenario{.odometry_scale = 1.1, .drift_rad_per_m = 0.02};
  Pose2 odom_from_base;
  for (const FusionMessage& message : MakeMessages(StraightDrive(), scenario, 1)) {
    if (const auto* motion = std::get_if<MotionMessage>(&message.content); IsWheels(motion)) {
      odom_from_base = odom_from_base * motion->increment.motion;
    }
  }
  EXPECT_NEAR(odom_from_base.yaw(), 0.02 * 30.0, 1e-6);
  EXPECT_NEAR(odom_from_base.translation().norm(), 33.0 * std::sin(0.3) / 0.3, 1e-3);  // the chord of an arc
}

TEST(FusionScenario, LetsWheelsSlip) {
  double distance_m = 0.0;
  for (const FusionMessage& message : MakeMessages(StraightDrive(), {.slips = 4}, 1)) {
    if (const auto* motion = std::get_if<MotionMessage>(&message.content); IsWheels(motion)) {
      distance_m += motion->increment.motion.x();
    }
  }
  EXPECT_NEAR(distance_m, 30.0 + 4 * 0.1, 0.005);
}

TEST(ReplayMessages, SamplesEveryIncrementOfEveryFuser) {
  FusionRecording recording = StraightDrive();
  recording.odometry.resize(501);
  recording.truth.resize(501);
  recording.images.resize(51);
  const std::vector<FusionMessage> messages = MakeMessages(recording, {}, 1);
  for (const FusionVariant& variant : AllFusionVariants()) {
    const std::vector<FusionSample> samples = ReplayMessages(messages, recording.truth, variant);
    ASSERT_EQ(samples.size(), 500U);
    ASSERT_TRUE(samples.back().estimate.has_value()) << variant.name;
    const double allowed_m = variant.method == FusionMethod::kFixes ? 0.061 : 0.005;  // fixes are 0.2 s old
    for (const FusionSample& sample : samples) {
      const Pose2 error = sample.truth.Between(sample.estimate->map_from_base);
      ASSERT_LT(error.translation().norm(), allowed_m) << variant.name << " at " << sample.stamp_ns;
    }
  }
}

}  // namespace
}  // namespace floorloc
