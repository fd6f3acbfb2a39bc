// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "core/fusion/pose_filter.h"
#include "tests/core/fusion/filtered_drive.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

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

// As images that are registered with each other where the floor's texture recurs.
TEST(PoseFilter, AWrongMotionBetweenImagesIsOutvotedByWheelsAndFix) {
  Drive drive(4, {.wheels = true, .vision = true});
  drive.RunTo(5.24);
  const std::int64_t stamp = kStartNs + ToNs(5.25);
  drive.truth = drive.truth * drive.simulation.Motion(5.24, 5.25);
  drive.now_ns = stamp;
  drive.filter.AddIncrement(MotionSource::kVision,
                            {stamp - kFixNs, stamp, Pose2(-1.0, 0.2, -0.9), drive.simulation.FixCovariance()});
  EXPECT_GT(drive.ErrorM(), 0.5);
  const FixOutcome fix = drive.filter.AddFix(drive.simulation.Fix(stamp, drive.truth));
  EXPECT_TRUE(fix.accepted);
  EXPECT_FALSE(fix.reanchored);
  EXPECT_LT(drive.ErrorM(), 0.005);
  drive.RunTo(8.0);
  EXPECT_TRUE(drive.last_fix.accepted);
  EXPECT_EQ(drive.filter.Estimate()->state, TrackingState::kLocalized);
  EXPECT_LT(drive.ErrorM(), 0.005);
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

}  // namespace
}  // namespace floorloc
