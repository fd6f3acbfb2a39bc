// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/start_score.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace floorloc {
namespace {

constexpr double kFrameM = 0.25;

// A straight drive along x whose frames are all localized but for those before `silent`.
RecordedDrive StraightDrive(int frames, int silent) {
  RecordedDrive drive;
  for (int i = 0; i < frames; ++i) {
    RecordedFrame frame;
    frame.stamp_ns = 500'000'000LL * i;
    frame.motions_before = static_cast<std::size_t>(i);
    frame.metres = kFrameM * i;
    frame.truth_from_base = frame.map_from_base = frame.global.map_from_base = Pose2(1.0 + kFrameM * i, 3.0, 0.0);
    frame.global.inliers = i < silent ? 0 : 20;
    frame.global.status = i < silent ? LocalizationStatus::kNotLocalized : LocalizationStatus::kLocalized;
    drive.frames.push_back(frame);
    drive.motions.push_back({frame.stamp_ns, frame.stamp_ns + 500'000'000LL, Pose2(kFrameM, 0.0, 0.0), std::nullopt});
    drive.tracked.emplace_back();
  }
  drive.motions.pop_back();
  return drive;
}

// Answers as scripted: the frame's pose, a wrong one, or none.
class ScriptedMethod : public StartMethod {
 public:
  explicit ScriptedMethod(std::string script) : script_(std::move(script)) {}

  void Move(const MotionIncrement& /*motion*/) override { ++moves; }
  std::optional<Pose2> See(const RecordedFrame& frame) override {
    const char answer = script_.at(seen_++);
    if (answer == '-') {
      return std::nullopt;
    }
    return answer == 'w' ? frame.map_from_base * Pose2(0.3, 0.0, 0.0) : frame.map_from_base;
  }

  int moves = 0;

 private:
  std::string script_;
  std::size_t seen_ = 0;
};

TEST(PlanStarts, SpreadsThemAndLeavesRoomToFollow) {
  const RecordedDrive drive = StraightDrive(41, 0);  // 10 m
  const std::vector<StartPlan> plans = PlanStarts(drive, 4, 6.0);
  ASSERT_EQ(plans.size(), 4U);
  EXPECT_EQ(plans.front().frame, 0U);
  for (const StartPlan& plan : plans) {
    EXPECT_LE(drive.frames[plan.frame].metres + 6.0, 10.0);
  }
  EXPECT_EQ(PlanStarts(drive, 1000, 6.0).size(), 17U);
  EXPECT_TRUE(PlanStarts(drive, 4, 11.0).empty());
}

TEST(ReplayStart, CountsFramesAndMetresFromTheStart) {
  const RecordedDrive drive = StraightDrive(21, 0);
  ScriptedMethod method("---+w");
  const StartOutcome outcome = ReplayStart(drive, MakeHall("tiles", 20), {4, 1.0}, &method);
  EXPECT_EQ(outcome.frames, 5);
  EXPECT_EQ(method.moves, 4);
  ASSERT_TRUE(outcome.first);
  EXPECT_EQ(outcome.first->frames, 4);
  EXPECT_NEAR(outcome.first->metres, 0.75, 1e-9);
  EXPECT_FALSE(outcome.first->wrong);
  EXPECT_EQ(outcome.answers, 2);
  EXPECT_EQ(outcome.wrong, 1);
}

TEST(ReplayStart, AnAnswerIsFoundedOnceTheMotionFitsNowhereElse) {
  const RectM view = BenchCamera().floor.roi;
  const Hall hall = MakeHall("tiles-identical", 10);  // 3 m
  const Pose2 corner(0.05 - view.x_min, 0.05 - view.y_min, 0.0);
  const Pose2 opposite(2.95 - view.x_max, 2.95 - view.y_max, 0.0);
  EXPECT_TRUE(FitsElsewhere({corner}, view, hall));
  EXPECT_FALSE(FitsElsewhere({corner, opposite}, view, hall));
  EXPECT_TRUE(FitsElsewhere({corner, Pose2(opposite.x() - 0.6, opposite.y(), 0.0)}, view, hall));
}

TEST(QuantileOfSome, CountsTheUnknownOnesAsLargest) {
  EXPECT_EQ(QuantileOfSome({3.0, 1.0, 2.0}, 4, 0.5), 2.0);
  EXPECT_EQ(QuantileOfSome({3.0, 1.0, 2.0}, 4, 0.75), 3.0);
  EXPECT_EQ(QuantileOfSome({3.0, 1.0, 2.0}, 4, 0.9), std::nullopt);
  EXPECT_EQ(QuantileOfSome({}, 0, 0.5), std::nullopt);
}

TEST(ScoreStarts, CountsWhatWasWrong) {
  StartOutcome right;
  right.first = FirstAnswer{2, 0.25, false, false};
  right.answers = 5;
  StartOutcome wrong;
  wrong.first = FirstAnswer{4, 0.75, true, true};
  wrong.answers = 3;
  wrong.wrong = 2;
  const StartScore score = ScoreStarts({right, wrong, StartOutcome(), right});
  EXPECT_EQ(score.starts, 4);
  EXPECT_EQ(score.localized, 3);
  EXPECT_EQ(score.first_wrong, 1);
  EXPECT_EQ(score.first_unfounded, 1);
  EXPECT_EQ(score.answers, 13);
  EXPECT_EQ(score.wrong_answers, 2);
  EXPECT_EQ(score.median_m, 0.25);
  EXPECT_EQ(score.ninety_m, std::nullopt);
}

TEST(ScoreFrames, SeparatesFramesWhileTracking) {
  RecordedDrive drive = StraightDrive(4, 1);
  drive.frames[3].global.map_from_base = Pose2(0.0, 0.0, 0.0);
  drive.tracked[2] = {true, true, false, 5.0, 0.1};
  drive.tracked[3] = {true, false, false, 7.0, 0.1};
  const FrameScore score = ScoreFrames({drive});
  EXPECT_EQ(score.frames, 4);
  EXPECT_EQ(score.compared, 0);
  EXPECT_EQ(score.right_alone, 2);
  EXPECT_EQ(score.wrong_alone, 1);
  EXPECT_EQ(score.expected, 2);
  EXPECT_EQ(score.localized, 1);
}

}  // namespace
}  // namespace floorloc
