// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/state_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "tests/core/fusion/filtered_drive.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

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

TEST(StateHistory, AppliesALateFixAtItsOwnTime) {
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

TEST(StateHistory, SortsLateIncrementsIn) {
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

TEST(StateHistory, IgnoresDuplicates) {
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

TEST(StateHistory, IgnoresWhatIsTooOldOrInvalid) {
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

TEST(StateHistory, GoesOnInTheNewTimeWhenTheClockWasSetBack) {
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

}  // namespace
}  // namespace floorloc
