// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/held_out.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mapbuilder/survey/extract_frames.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::IsEmpty;

// A survey with frames at their true poses.
class HeldOutTest : public ::testing::Test {
 protected:
  HeldOutTest() {
    static const TemporaryFolder folder;
    static const bool written = SyntheticFloor(1).WriteSurvey(folder.path() / "survey").frames > 0;
    EXPECT_TRUE(written);
    surveys_ = LoadSurveys({folder.path() / "survey"});
    static const std::vector<BuildFrame> frames = ExtractSurveyFrames(surveys_, {});
    frames_ = frames;
    const Survey& survey = surveys_.front().survey;
    for (const BuildFrame& frame : frames_) {
      map_from_base_.push_back(InterpolatePose(survey.ground_truth, frame.info.stamp_ns));
      floors_.push_back(survey.camera.floor.roi);
    }
    options_.max_share = 0.2;
    options_.min_others = 1;
    options_.min_covered_share = 0.6;
    options_.fusion = options_.fusion.ForCamera(survey.camera.floor, options_.extractor.max_keypoints);
  }

  PlacedSurvey Placed() const { return {frames_, surveys_, map_from_base_, floors_}; }

  std::vector<LoadedSurvey> surveys_;
  std::vector<BuildFrame> frames_;
  std::vector<std::optional<Pose2>> map_from_base_;
  std::vector<RectM> floors_;
  HeldOutOptions options_;
};

TEST_F(HeldOutTest, FramesWhoseViewsAreApartAreChosen) {
  const std::vector<int> chosen = ChooseHeldOut(Placed(), options_);
  ASSERT_GE(chosen.size(), 2U);
  EXPECT_LE(chosen.size(), 6U);
  const double diagonal_m = std::hypot(floors_.front().width_m(), floors_.front().height_m());
  for (std::size_t i = 1; i < chosen.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto center = [&](int frame) {
        return *map_from_base_[static_cast<std::size_t>(frame)] * floors_.front().Center();
      };
      EXPECT_GE((center(chosen[i]) - center(chosen[k])).norm(), diagonal_m);
    }
  }
}

TEST_F(HeldOutTest, FloorThatNoOtherFrameCoversIsNotChosen) {
  options_.min_others = 30;
  EXPECT_THAT(ChooseHeldOut(Placed(), options_), IsEmpty());
  EXPECT_THAT(LocalizeHeldOut(Placed(), options_), IsEmpty());
}

TEST_F(HeldOutTest, HeldOutFramesAreLocalizedWhereTheyAre) {
  for (const HeldOutFrame& frame : LocalizeHeldOut(Placed(), options_)) {
    EXPECT_EQ(frame.status, "localized") << frame.filename;
    EXPECT_LT(frame.error_m, 1e-3);
    EXPECT_GT(frame.inliers, 30);
  }
}

TEST_F(HeldOutTest, AMisplacedFrameIsReportedAsWrong) {
  const int misplaced = ChooseHeldOut(Placed(), options_).front();
  auto& pose = map_from_base_[static_cast<std::size_t>(misplaced)];
  pose = Pose2(0.03, 0.0, 0.0) * *pose;
  const std::vector<HeldOutFrame> results = LocalizeHeldOut(Placed(), options_);
  EXPECT_EQ(results.front().status, "wrong");
  EXPECT_NEAR(results.front().error_m, 0.03, 1e-3);
}

TEST_F(HeldOutTest, AFrameOfAnotherFloorIsNotFound) {
  const int frame = ChooseHeldOut(Placed(), options_).front();
  const TemporaryFolder folder;
  SyntheticFloor(2).WriteSurvey(folder.path() / "survey");
  // The image is read again, now from the other floor's folder.
  surveys_.front().survey.folder = folder.path() / "survey";
  const std::vector<HeldOutFrame> results = LocalizeHeldOut(Placed(), options_);
  EXPECT_EQ(results.front().filename, frames_[static_cast<std::size_t>(frame)].info.filename);
  EXPECT_NE(results.front().status, "localized");
  EXPECT_FALSE(results.front().reason.empty());
}

}  // namespace
}  // namespace floorloc
