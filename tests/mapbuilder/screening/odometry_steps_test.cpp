// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "mapbuilder/survey/extract_frames.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A survey of 28 frames in four lanes, with the odometry of its simulated wheels.
const FrameSet& Recorded() {
  static const FrameSet set = [] {
    const TemporaryFolder folder;
    SyntheticFloor(1).WriteSurvey(folder.path() / "survey");
    FrameSet all;
    all.surveys = LoadSurveys({folder.path() / "survey"});
    all.frames = ExtractSurveyFrames(all.surveys, {});
    return all;
  }();
  return set;
}

using Jump = std::function<Pose2(const Pose2&)>;

// From this frame on, odometry is what `jump` makes of it, in the frames and in the trajectory.
FrameSet WithJump(FrameSet set, std::size_t from, const Jump& jump) {
  const std::int64_t stamp_ns = set.frames[from].info.stamp_ns;
  for (std::size_t i = from; i < set.frames.size(); ++i) {
    set.frames[i].odom_from_base = jump(*set.frames[i].odom_from_base);
  }
  for (StampedPose3& row : set.surveys[0].survey.odometry) {
    if (row.stamp_ns >= stamp_ns) {
      row = StampedPose3::FromPose2(row.stamp_ns, jump(row.ToPose2()));
    }
  }
  return set;
}

Jump Shift(double x_m) {
  return [x_m](const Pose2& pose) { return Pose2(x_m, 0.0, 0.0) * pose; };
}

// What a wheel controller does that restarts: from here on, pose and heading count from zero.
Jump Reset(std::size_t frame) {
  const Pose2 start = *Recorded().frames[frame].odom_from_base;
  return [start](const Pose2& pose) { return start.Inverse() * pose; };
}

std::vector<int> FirstFrames(const std::vector<FalseOdometryStep>& steps) {
  std::vector<int> first;
  for (const FalseOdometryStep& step : steps) {
    first.push_back(step.first);
  }
  return first;
}

std::vector<FalseOdometryStep> Find(const FrameSet& set) { return FindFalseOdometrySteps(set, {}, {}); }

// Largest difference to the recorded odometry after the false steps were taken out.
double LargestDifferenceM(const FrameSet& mended) {
  double largest = 0.0;
  for (std::size_t i = 0; i < mended.frames.size(); ++i) {
    const Pose2 off = mended.frames[i].odom_from_base->Between(*Recorded().frames[i].odom_from_base);
    largest = std::max({largest, off.translation().norm(), std::abs(off.yaw())});
  }
  return largest;
}

TEST(OdometryStepsTest, WheelsThatOnlyDriftHaveNone) { EXPECT_THAT(Find(Recorded()), IsEmpty()); }

TEST(OdometryStepsTest, JumpsAreFoundAndTakenOut) {
  for (const Jump& jump : {Shift(2.0), Shift(0.6), Shift(0.15), Reset(17)}) {
    const FrameSet jumped = WithJump(Recorded(), 17, jump);
    const std::vector<FalseOdometryStep> steps = Find(jumped);
    ASSERT_THAT(FirstFrames(steps), ElementsAre(16));
    ASSERT_TRUE(steps[0].by_images);
    const FrameSet mended = WithoutSteps(jumped, steps);
    EXPECT_LT(LargestDifferenceM(mended), 0.02);
    EXPECT_FALSE(mended.frames[17].odometry_breaks);
    for (const BuildFrame& frame : mended.frames) {
      const auto row = InterpolatePose(mended.surveys[0].survey.odometry, frame.info.stamp_ns);
      ASSERT_TRUE(row);
      EXPECT_LT((row->translation() - frame.odom_from_base->translation()).norm(), 1e-6) << frame.info.filename;
    }
  }
}

TEST(OdometryStepsTest, SeveralJumpsAreTakenOut) {
  const FrameSet jumped = WithJump(WithJump(WithJump(Recorded(), 5, Shift(2.0)), 11, Shift(-0.6)), 20, Reset(20));
  EXPECT_THAT(FirstFrames(Find(jumped)), ElementsAre(4, 10, 19));
  EXPECT_LT(LargestDifferenceM(WithoutSteps(jumped, Find(jumped))), 0.03);
}

TEST(OdometryStepsTest, AJumpThatImagesCannotSeeIsFoundBySpeed) {
  FrameSet jumped = WithJump(Recorded(), 17, Shift(3.0));
  jumped.frames[17].features = {};
  const std::vector<FalseOdometryStep> steps = Find(jumped);
  ASSERT_THAT(FirstFrames(steps), ElementsAre(16));
  EXPECT_FALSE(steps[0].by_images);
  EXPECT_GT(steps[0].times_usual, 5.0);
  const FrameSet mended = WithoutSteps(jumped, steps);
  EXPECT_TRUE(mended.frames[17].odometry_breaks);
  EXPECT_LT(LargestDifferenceM(mended), 0.3) << "goes on as before";
  for (const FramePair& pair : SelectConsecutivePairs(mended.frames)) {
    EXPECT_EQ(pair.first_from_second.has_value(), pair.first != 16);
  }
}

TEST(OdometryStepsTest, AnImageWithoutTextureIsNoReasonToCut) {
  FrameSet set = Recorded();
  set.frames[9].features = {};
  EXPECT_THAT(Find(set), IsEmpty());
}

// Odometry stands still at frame `from` until frame `to`, as with an encoder that fails.
FrameSet WithStandstill(FrameSet set, std::size_t from, std::size_t to) {
  const Pose2 stands = *set.frames[from].odom_from_base;
  const Pose2 lost = stands * set.frames[to].odom_from_base->Inverse();
  for (std::size_t i = from; i < set.frames.size(); ++i) {
    set.frames[i].odom_from_base = i < to ? stands : lost * *set.frames[i].odom_from_base;
  }
  for (StampedPose3& row : set.surveys[0].survey.odometry) {
    if (row.stamp_ns >= set.frames[from].info.stamp_ns) {
      const bool later = row.stamp_ns >= set.frames[to].info.stamp_ns;
      row = StampedPose3::FromPose2(row.stamp_ns, later ? lost * row.ToPose2() : stands);
    }
  }
  return set;
}

TEST(OdometryStepsTest, AnEncoderThatStandsIsFoundAndTakenOut) {
  const FrameSet standing = WithStandstill(Recorded(), 8, 13);
  const std::vector<FalseOdometryStep> steps = Find(standing);
  EXPECT_THAT(FirstFrames(steps), ElementsAre(8, 9, 10, 11, 12));
  for (const FalseOdometryStep& step : steps) {
    EXPECT_TRUE(step.standing);
    EXPECT_TRUE(step.by_images);
  }
  EXPECT_LT(LargestDifferenceM(WithoutSteps(standing, steps)), 0.05);
  FrameSet mended = standing;
  EXPECT_THAT(MendOdometry({}, {}, &mended),
              ElementsAre(AllOf(HasSubstr("odometry.tum: stands still for "), HasSubstr("images/000008.jpg"),
                                HasSubstr("images/000013.jpg"), HasSubstr("check the encoder"))));
}

TEST(OdometryStepsTest, WhatImagesCannotSeeWhileAnEncoderStandsIsCut) {
  FrameSet standing = WithStandstill(Recorded(), 8, 13);
  standing.frames[10].features = {};
  const std::vector<FalseOdometryStep> steps = Find(standing);
  EXPECT_THAT(FirstFrames(steps), ElementsAre(8, 9, 10, 11, 12));
  const FrameSet mended = WithoutSteps(standing, steps);
  EXPECT_TRUE(mended.frames[10].odometry_breaks);
  EXPECT_TRUE(mended.frames[11].odometry_breaks);
  EXPECT_FALSE(mended.frames[9].odometry_breaks);
}

TEST(OdometryStepsTest, StepsAreNamed) {
  FrameSet jumped = WithJump(WithJump(Recorded(), 17, Shift(2.0)), 24, Reset(24));
  EXPECT_THAT(
      MendOdometry({}, {}, &jumped),
      ElementsAre(AllOf(HasSubstr("odometry.tum: step of "), HasSubstr("images/000016.jpg and images/000017.jpg"),
                        HasSubstr("contradicts the images"), HasSubstr("left out")),
                  HasSubstr("images/000023.jpg and images/000024.jpg")));
  EXPECT_LT(LargestDifferenceM(jumped), 0.03);
  OdometryStepOptions one;
  one.named = 1;
  jumped = WithJump(WithJump(Recorded(), 17, Shift(2.0)), 24, Reset(24));
  EXPECT_THAT(MendOdometry({}, one, &jumped), ElementsAre(HasSubstr("000016.jpg"), HasSubstr("1 more steps")));
}

TEST(OdometryStepOptionsTest, RefusesNonsense) {
  EXPECT_NO_THROW(OdometryStepOptions().Check());
  OdometryStepOptions options;
  options.max_times_usual = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.max_times_standing = 1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.min_standing_steps = 0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.named = 0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
