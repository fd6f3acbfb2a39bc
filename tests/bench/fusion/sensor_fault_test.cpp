// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/sensor_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/bench/fusion/fault_table.h"

namespace floorloc {
namespace {

constexpr std::int64_t kWheelNs = 20'000'000;
constexpr std::int64_t kFixNs = 200'000'000;

// 30 s along x at 0.5 m/s, odometry at 50 Hz, 5 fixes per second, all exact.
FusionRecording StraightDrive() {
  FusionRecording recording;
  for (std::int64_t stamp_ns = 0; stamp_ns <= 30'000'000'000; stamp_ns += kWheelNs) {
    const Pose2 pose(0.5e-9 * static_cast<double>(stamp_ns), 0.0, 0.0);
    recording.odometry.push_back(StampedPose3::FromPose2(stamp_ns, pose));
    recording.truth.push_back(StampedPose3::FromPose2(stamp_ns, pose));
    if (stamp_ns % kFixNs == 0) {
      recording.images.push_back(
          {stamp_ns, PoseFix{stamp_ns, pose, 1e-6 * Eigen::Matrix3d::Identity(), 1e-9}, std::nullopt});
    }
  }
  return recording;
}

double MetresSaid(const std::vector<FusionMessage>& messages, double from_s, double to_s) {
  double metres = 0.0;
  for (const FusionMessage& message : messages) {
    const auto* motion = std::get_if<MotionMessage>(&message.content);
    const double arrival_s = ToSeconds(message.arrival_ns);
    metres += motion != nullptr && arrival_s > from_s && arrival_s <= to_s ? motion->increment.motion.x() : 0.0;
  }
  return metres;
}

std::size_t CountFixes(const std::vector<FusionMessage>& messages) {
  return static_cast<std::size_t>(std::count_if(messages.begin(), messages.end(), [](const FusionMessage& message) {
    return std::holds_alternative<PoseFix>(message.content);
  }));
}

TEST(SensorFault, BeginsAtItsOnset) {
  const auto messages = MakeFaultyMessages(StraightDrive(), {.name = "reversed", .scale = -1.0}, 1);
  EXPECT_NEAR(MetresSaid(messages, 0.0, kFaultOnsetS), 0.5 * kFaultOnsetS, 1e-6);
  EXPECT_NEAR(MetresSaid(messages, kFaultOnsetS, kFaultOnsetS + 10.0), -5.0, 1e-6);
}

TEST(SensorFault, EndsWhenItHasLasted) {
  const auto messages = MakeFaultyMessages(StraightDrive(), {.name = "standing", .lasts_s = 4.0, .standing = true}, 1);
  EXPECT_NEAR(MetresSaid(messages, kFaultOnsetS, kFaultOnsetS + 4.0), 0.0, 1e-6);
  EXPECT_NEAR(MetresSaid(messages, kFaultOnsetS + 4.0, kFaultOnsetS + 6.0), 1.0, 1e-6);
}

TEST(SensorFault, KeepsEveryFewImages) {
  EXPECT_EQ(CountFixes(MakeFaultyMessages(StraightDrive(), {}, 1)), 151U);
  EXPECT_EQ(CountFixes(MakeFaultyMessages(StraightDrive(), {}, 25)), 7U);
}

FrameAnswer AnswerAt(double error_m, double sigma_m, TrackingState state) {
  FusedPose pose;
  pose.map_from_base = Pose2(error_m, 0.0, 0.0);
  pose.covariance = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
  pose.state = state;
  return {0, pose, Pose2()};
}

TEST(FaultScore, CountsGoodAnswersAndTheLongestRunOfWrongOnes) {
  FaultScore score;
  ScoreAnswers({AnswerAt(0.001, 0.001, TrackingState::kLocalized), AnswerAt(0.02, 0.001, TrackingState::kLocalized),
                AnswerAt(0.2, 0.001, TrackingState::kTrackingOdometry), AnswerAt(5.0, 0.001, TrackingState::kLost),
                AnswerAt(0.2, 0.001, TrackingState::kTrackingOdometry), FrameAnswer{0, std::nullopt, Pose2()}},
               &score);
  EXPECT_EQ(score.frames, 6U);
  EXPECT_EQ(score.good, 1U);
  EXPECT_EQ(score.tracking, 2U);
  EXPECT_EQ(score.lost, 2U);
  EXPECT_EQ(score.longest_wrong_run, 2);
  EXPECT_EQ(score.nees.size(), 4U);
}

TEST(FaultScore, TheFilterNoticesWhatTheOldOneDidNot) {
  const FusionRecording recording = StraightDrive();
  const auto messages = MakeFaultyMessages(recording, {.name = "reversed", .scale = -1.0}, 5);
  FusionVariant trusting{"before", FusionMethod::kEkf};
  trusting.options.monitor.enabled = false;
  const FaultScore before = ReplayFault(recording, messages, trusting);
  const FaultScore now = ReplayFault(recording, messages, {"now", FusionMethod::kEkf});
  EXPECT_LT(before.good, before.frames / 2);
  EXPECT_EQ(now.good, now.frames);
  EXPECT_LE(now.longest_wrong_run, 0);
}

TEST(FaultTable, ShowsACellPerVariant) {
  FaultScore score;
  score.frames = 200;
  score.good = 150;
  score.longest_wrong_run = 3;
  score.nees = {1.0, 2.0, 5.0};
  score.between = {0.3, 0.4};
  std::ostringstream out;
  PrintFaultTable(out, {{"ours"}}, {{"rain", 0.2, {score}}});
  EXPECT_THAT(out.str(), testing::HasSubstr("| rain | 0.2 | 75.0; 2.0; 3; 354 |"));
}

}  // namespace
}  // namespace floorloc
