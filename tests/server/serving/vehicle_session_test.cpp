// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_session.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace floorloc {
namespace {

std::int64_t Ns(double seconds) { return *ToStampNs(seconds); }

LocalizationResult FoundAt(const Pose2& pose, double p_wrong = 1e-9) {
  LocalizationResult found;
  found.status = LocalizationStatus::kLocalized;
  found.map_from_base = pose;
  found.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
  found.p_wrong = p_wrong;
  return found;
}

/// A vehicle with simulated localizations: its images have no features, but each has a result.
class VehicleSessionTest : public testing::Test {
 protected:
  FrameReport Frame(double stamp_s, const LocalizationResult& found, const std::optional<Pose2>& motion = Pose2()) {
    const auto slot = session_.BeginFrame({Ns(stamp_s), motion});
    EXPECT_TRUE(slot.has_value());
    return session_.FinishFrame(*slot, {}, found);
  }
  FrameReport Frame(double stamp_s, const Pose2& pose) { return Frame(stamp_s, FoundAt(pose)); }
  MessageOutcome Odometry(double stamp_s, const Pose2& motion = {}) {
    return session_.AddOdometry({{Ns(stamp_s), motion}}).messages.back();
  }
  FixRejection Rejection(const FrameReport& report) {
    EXPECT_TRUE(report.fix.has_value() && !report.fix->accepted);
    return report.fix ? report.fix->reason : FixRejection::kNone;
  }

  VehicleSession session_{{}, 0.001, 0.0};
};

TEST_F(VehicleSessionTest, TheFirstFixIsThePose) {
  EXPECT_EQ(session_.View().state(), TrackingState::kLost);
  EXPECT_FALSE(session_.View().fused.has_value());
  const FrameReport report = Frame(100.0, Pose2(1, 2, 3));
  EXPECT_EQ(report.message, MessageOutcome::kUsed);
  EXPECT_TRUE(report.fix->accepted);
  EXPECT_EQ(report.view.state(), TrackingState::kLocalized);
  EXPECT_EQ(report.view.fused->stamp_ns, Ns(100.0));
  EXPECT_GT(report.view.next.seconds, 0.0);
}

// Who looks while an image is localized must look again.
TEST_F(VehicleSessionTest, AnImageIsAChangeWhenItComesAndWhenItIsLocalized) {
  const std::int64_t before = session_.Changes();
  const auto slot = session_.BeginFrame({Ns(100.0), Pose2()});
  const std::int64_t begun = session_.Changes();
  session_.FinishFrame(*slot, {}, FoundAt(Pose2(1, 2, 3)));
  EXPECT_GT(begun, before);
  EXPECT_GT(session_.Changes(), begun);
}

TEST_F(VehicleSessionTest, IncrementsBeginAtThePreviousMessage) {
  Odometry(100.0, Pose2(5, 5, 1));  // no previous message: ignored
  Frame(100.1, Pose2(1, 0, 0));
  Odometry(100.2, Pose2(0.1, 0, 0));
  const auto pose = session_.View().fused->map_from_base;
  EXPECT_NEAR(pose.x(), 1.1, 1e-3);
  EXPECT_NEAR(session_.View().fused->since_fix->metres, 0.1, 1e-3);
}

// Odometry and camera are independent: an image between two odometry messages does not split the increment.
TEST_F(VehicleSessionTest, AnImageWithoutOdometryDoesNotCutAnIncrement) {
  Frame(100.0, Pose2());
  Odometry(100.1, Pose2(0.05, 0, 0));
  Frame(100.15, FoundAt(Pose2(0.075, 0, 0)), std::nullopt);
  Odometry(100.2, Pose2(0.05, 0, 0));
  EXPECT_NEAR(session_.View().fused->map_from_base.x(), 0.10, 2e-3);
  EXPECT_NEAR(session_.View().fused->odom_from_base.x(), 0.10, 1e-9);
}

TEST_F(VehicleSessionTest, MessagesOutOfOrderCountAtTheirTime) {
  Frame(100.0, Pose2());
  EXPECT_EQ(Odometry(100.1, Pose2(0.01, 0, 0)), MessageOutcome::kUsed);
  EXPECT_EQ(Odometry(100.3, Pose2(0.02, 0, 0)), MessageOutcome::kUsed);
  EXPECT_EQ(Odometry(100.2, Pose2(0.03, 0, 0)), MessageOutcome::kUsedLate);
  EXPECT_NEAR(session_.View().fused->map_from_base.x(), 0.06, 1e-3);
  EXPECT_EQ(Odometry(100.2, Pose2(0.03, 0, 0)), MessageOutcome::kDuplicate);
  EXPECT_NEAR(session_.View().fused->map_from_base.x(), 0.06, 1e-3);
  EXPECT_EQ(Odometry(90.0), MessageOutcome::kTooOld);
  EXPECT_EQ(Frame(100.25, Pose2(0.05, 0, 0)).message, MessageOutcome::kUsedLate);
}

TEST_F(VehicleSessionTest, EveryReasonToRejectIsReached) {
  Frame(100.0, Pose2());
  EXPECT_EQ(Rejection(Frame(100.1, FoundAt(Pose2(), 0.5))), FixRejection::kWrongFixRisk);
  EXPECT_EQ(Rejection(Frame(100.2, Pose2(1, 0, 0))), FixRejection::kJumpDistance);
  EXPECT_EQ(Rejection(Frame(100.3, Pose2(0, 0, 1))), FixRejection::kJumpAngle);
  EXPECT_EQ(Rejection(Frame(100.4, Pose2(0.15, 0, 0))), FixRejection::kMahalanobis);
  EXPECT_EQ(Rejection(Frame(100.4, Pose2())), FixRejection::kDuplicate);
  EXPECT_EQ(Rejection(Frame(90.0, Pose2())), FixRejection::kTooOld);
  LocalizationResult broken = FoundAt(Pose2());
  broken.covariance(0, 0) = -1.0;
  EXPECT_EQ(Rejection(Frame(100.5, broken)), FixRejection::kInvalid);
  const VehicleCounts counts = session_.View().counts;
  EXPECT_EQ(counts.accepted, 1U);
  for (const FixRejection reason : counts.rejected.Values()) {
    EXPECT_EQ(counts.rejected[reason], reason == FixRejection::kNone ? 0U : 1U) << ToString(reason);
  }
}

// Also of what was refused: a clock of another epoch shows in nothing else.
TEST_F(VehicleSessionTest, ItsRecordHasEveryMessage) {
  Frame(1'700'000'000.0, FoundAt(Pose2(1, 2, 3)), std::nullopt);
  EXPECT_EQ(Odometry(40.0), MessageOutcome::kTooOld);
  Frame(1'700'000'001.0, FoundAt(Pose2(1, 2, 3)), Pose2());
  Frame(1'700'000'001.0, FoundAt(Pose2(1, 2, 3)), Pose2());  // sent again
  const DriveRecord record = session_.Record();
  ASSERT_EQ(record.frames().size(), 2U);
  EXPECT_TRUE(record.frames().back().IsLocalized());
  EXPECT_EQ(record.odometry_stamps().size(), 2U);
  EXPECT_EQ(record.odometry_stamps().Range().first_ns, Ns(40.0));
  EXPECT_EQ(record.frames_since_odometry(), 1U);
}

// So that a log has a line for each change, not for each image.
TEST_F(VehicleSessionTest, ItSaysWhenItsOdometryIsRejectedAndUsedAgain) {
  std::vector<int> changes;
  Pose2 truth;
  for (int i = 0; i < 40; ++i) {
    const Pose2 step(0.2, 0.0, 0.1);
    truth = truth * step;
    const bool reversed = i >= 5 && i < 15;
    const FrameReport report = Frame(100.0 + i, FoundAt(truth), reversed ? Pose2(-0.2, 0.0, 0.1) : step);
    if (report.odometry_changed) {
      changes.push_back(i);
    }
  }
  ASSERT_EQ(changes.size(), 2U) << testing::PrintToString(changes);
  EXPECT_TRUE(changes[0] > 5 && changes[0] < 15) << changes[0];
  EXPECT_GT(changes[1], 15);
}

// Whoever adds an enumerator before kCount gets a counter and must give it a name.
template <typename Enum>
void ExpectACounterAndANameForEach(Enum last) {
  EnumCounts<Enum> counts;
  std::set<std::string> names;
  for (const Enum value : counts.Values()) {
    EXPECT_EQ(counts[value], 0U);
    ++counts[value];
    names.insert(ToString(value));
  }
  for (const Enum value : counts.Values()) {
    EXPECT_EQ(counts[value], 1U) << ToString(value);
  }
  EXPECT_EQ(names.size(), counts.Values().size());
  EXPECT_EQ(counts.Values().back(), last);
}

TEST(EnumCountsTest, EveryOutcomeAndReasonHasACounterAndANameOfItsOwn) {
  ExpectACounterAndANameForEach(MessageOutcome::kInvalid);
  ExpectACounterAndANameForEach(FixRejection::kInvalid);
}

TEST_F(VehicleSessionTest, AKidnappedVehicleIsFoundAgain) {
  Frame(100.0, Pose2());
  EXPECT_FALSE(Frame(100.1, Pose2(3, 1, 1)).fix->accepted);
  EXPECT_FALSE(Frame(100.2, Pose2(3, 1, 1)).fix->accepted);
  const FrameReport report = Frame(100.3, Pose2(3, 1, 1));
  EXPECT_TRUE(report.fix->accepted && report.fix->reanchored);
  EXPECT_NEAR(report.view.fused->map_from_base.x(), 3.0, 1e-3);
  EXPECT_EQ(report.view.counts.reanchored, 1U);
}

TEST_F(VehicleSessionTest, AClockStepIsDetectedByOdometryAndByImagesAlone) {
  Frame(100.0, Pose2(1, 0, 0));
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(Odometry(50.0 + 0.1 * i), MessageOutcome::kTooOld);
  }
  EXPECT_EQ(Odometry(50.4), MessageOutcome::kClockJump);
  EXPECT_NEAR(session_.View().fused->map_from_base.x(), 1.0, 0.01);
  EXPECT_EQ(session_.View().fused->stamp_ns, Ns(50.4));
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(Frame(10.0 + 0.1 * i, FoundAt(Pose2()), std::nullopt).message, MessageOutcome::kTooOld);
  }
  const FrameReport report = Frame(10.4, FoundAt(Pose2(2, 0, 0)), std::nullopt);
  EXPECT_EQ(report.message, MessageOutcome::kClockJump);
  EXPECT_TRUE(report.fix->accepted);
  EXPECT_EQ(report.view.fused->stamp_ns, Ns(10.4));
}

TEST_F(VehicleSessionTest, OneImageAtATimeAndOdometryMeanwhile) {
  Frame(100.0, Pose2());
  auto slot = session_.BeginFrame({Ns(100.1), Pose2(0.1, 0, 0)});
  ASSERT_TRUE(slot.has_value());
  EXPECT_FALSE(session_.BeginFrame({Ns(100.2)}).has_value());
  EXPECT_EQ(Odometry(100.2, Pose2(0.1, 0, 0)), MessageOutcome::kUsed);
  const FrameReport report = session_.FinishFrame(*slot, {}, FoundAt(Pose2(0.101, 0, 0)));
  EXPECT_TRUE(report.fix->accepted);
  EXPECT_NEAR(report.view.fused->map_from_base.x(), 0.201, 2e-3);
  slot.reset();
  EXPECT_TRUE(session_.BeginFrame({Ns(100.3)}).has_value());
}

TEST_F(VehicleSessionTest, AnImageThatIsSentAgainBringsItsOdometryOnce) {
  Frame(100.0, Pose2());
  session_.BeginFrame({Ns(100.1), Pose2(0.1, 0, 0)});  // and localization failed
  const FrameReport report = Frame(100.1, FoundAt(Pose2(0.1, 0, 0)), Pose2(0.1, 0, 0));
  EXPECT_NE(report.message, MessageOutcome::kDuplicate);
  EXPECT_TRUE(report.fix->accepted);
  EXPECT_NEAR(report.view.fused->map_from_base.x(), 0.1, 1e-3);
}

TEST_F(VehicleSessionTest, ASetPoseIsWhereTheNextFixIsExpected) {
  PoseFix pose;
  pose.map_from_base = Pose2(1, 1, 1);
  pose.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  EXPECT_NEAR(session_.SetPose(pose, std::nullopt).fused->map_from_base.x(), 1.0, 1e-9);
  // The first message defines the vehicle's clock.
  EXPECT_EQ(Rejection(Frame(5.0, Pose2(3, 1, 1))), FixRejection::kJumpDistance);
  EXPECT_TRUE(Frame(5.1, Pose2(1.01, 1, 1)).fix->accepted);
  const auto slot = session_.BeginFrame({Ns(5.2)});
  EXPECT_TRUE(slot->prior.has_value());
}

TEST(VehicleExpiryTest, ASilentVehicleIsLost) {
  VehicleSession session({}, 0.001, 1e-9);
  const auto slot = session.BeginFrame({Ns(100.0)});
  session.FinishFrame(*slot, {}, FoundAt(Pose2()));
  EXPECT_TRUE(session.Expired());
  EXPECT_EQ(session.View().state(), TrackingState::kLost);
  EXPECT_FALSE(session.AddOdometry({{Ns(100.1), Pose2()}}).view.fused.has_value());
  EXPECT_FALSE(VehicleSession({}, 0.001, 0.0).Expired());
}

SessionStart RememberedAt(double stamp_s) {
  SessionStart start;
  start.epoch = 5;
  start.silent_s = 30.0;
  start.pose = PoseFix{Ns(stamp_s), Pose2(1.0, 2.0, 0.0), Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal()};
  return start;
}

// What it did in the meantime is unknown.
TEST_F(VehicleSessionTest, ARememberedPoseIsAsUncertainAsTheTimeSince) {
  session_.Start(RememberedAt(100.0));
  EXPECT_EQ(session_.View().epoch, 6U);
  EXPECT_GE(session_.View().silent_s, 30.0);
  EXPECT_NEAR(session_.View().fused->map_from_base.x(), 1.0, 1e-9);
  Odometry(101.0, Pose2(0.1, 0.0, 0.0));
  Odometry(101.1, Pose2(0.1, 0.0, 0.0));
  const VehicleView view = session_.View();
  EXPECT_NEAR(view.fused->map_from_base.x(), 1.1, 0.01);
  EXPECT_GT(std::sqrt(view.fused->covariance(0, 0)), 0.2);
}

TEST_F(VehicleSessionTest, ARememberedPoseOfAnotherClockIsForgotten) {
  session_.Start(RememberedAt(100.0));
  EXPECT_EQ(Odometry(7.0), MessageOutcome::kUsed);
  EXPECT_FALSE(session_.View().fused);
}

TEST_F(VehicleSessionTest, AReasonOfLossLastsUntilTheNextPose) {
  SessionStart start;
  start.lost_reason = LostReason::kMapChanged;
  session_.Start(start);
  Odometry(1.0);
  EXPECT_EQ(session_.View().lost_reason, LostReason::kMapChanged);
  Frame(2.0, Pose2(1.0, 2.0, 0.0));
  EXPECT_EQ(session_.View().lost_reason, LostReason::kNone);
}

}  // namespace
}  // namespace floorloc
