// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/auto_mask.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/survey/extract_frames.h"
#include "tests/option_test_support.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// A survey of 28 frames, without and with a plate that has the texture of a floor at the left edge of every image. Made
// and extracted once for all tests.
class AutoMaskTest : public ::testing::Test {
 protected:
  struct Survey {
    explicit Survey(bool with_plate) {
      const SyntheticFloor floor(1);
      floor.WriteSurvey(folder.path());
      const cv::Mat elsewhere = floor.View(floor.BaseForView(0.9, 0.6, 2.0));
      for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "images")) {
        cv::Mat image = cv::imread(entry.path().string());
        if (with_plate) {
          elsewhere(kPlate).copyTo(image(kPlate));
        }
        cv::imwrite(entry.path().string(), image);
      }
      set.surveys = LoadSurveys({folder.path()});
      set.frames = ExtractSurveyFrames(set.surveys, {});
    }

    TemporaryFolder folder;
    FrameSet set;
  };

  AutoMaskTest() { registration_.resolution_m = Clean().surveys[0].survey.camera.floor.resolution_m; }

  static const FrameSet& Clean() {
    static const Survey survey(false);
    return survey.set;
  }
  static const FrameSet& WithPlate() {
    static const Survey survey(true);
    return survey.set;
  }

  CameraMaskFinding Find(const FrameSet& set) const { return FindCameraMasks(set, registration_, {}).at(0); }

  void ExpectPlate(const CameraMaskFinding& finding) const {
    EXPECT_EQ(finding.status, CameraMaskStatus::kFound);
    EXPECT_TRUE(finding.applied);
    cv::Mat part = cv::Mat::zeros(480, 640, CV_8U);
    part(kPlate).setTo(255);
    ASSERT_EQ(finding.mask.size(), part.size());
    EXPECT_GE(cv::countNonZero((finding.mask == 0) & part), 0.95 * kPlate.area());
    EXPECT_LE(cv::countNonZero((finding.mask == 0) & ~part), 0.02 * static_cast<double>(part.total()));
    EXPECT_NEAR(finding.share, kPlate.area() / static_cast<double>(part.total()), 0.02);
  }

  inline static const cv::Rect kPlate{0, 0, 180, 480};
  PairRegistrationOptions registration_;
};

TEST_F(AutoMaskTest, APlateIsFound) {
  const CameraMaskFinding finding = Find(WithPlate());
  ExpectPlate(finding);
  EXPECT_FALSE(finding.picture.empty());
  const LoadedSurvey masked = WithMask(WithPlate().surveys.at(0), finding.mask);
  EXPECT_NEAR(masked.rectifier->masked_share(), 0.28, 0.04);
}

TEST_F(AutoMaskTest, APlateIsFoundWithoutOdometry) {
  FrameSet set = WithPlate();
  for (BuildFrame& frame : set.frames) {
    frame.odom_from_base.reset();
  }
  ExpectPlate(Find(set));
}

TEST_F(AutoMaskTest, NothingIsMaskedWhereNothingMovesWithTheCamera) {
  FrameSet set = Clean();
  CameraMaskFinding finding = Find(set);
  EXPECT_EQ(finding.status, CameraMaskStatus::kNothing);
  EXPECT_TRUE(finding.mask.empty());
  set.frames.resize(12);
  finding = Find(set);
  EXPECT_EQ(finding.share, 0.0);
  set.frames.resize(4);
  EXPECT_EQ(Find(set).status, CameraMaskStatus::kUndecided);
}

TEST_F(AutoMaskTest, AGivenMaskWins) {
  FrameSet set = WithPlate();
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 0, 10, 10)).setTo(0);
  set.surveys.at(0).survey.mask = mask;
  const CameraMaskFinding finding = Find(set);
  EXPECT_EQ(finding.status, CameraMaskStatus::kGiven);
  EXPECT_NEAR(finding.share, 100.0 / (640.0 * 480.0), 1e-9);
}

TEST_F(AutoMaskTest, WhatIsNotToBeAppliedIsReportedOnly) {
  AutoMaskOptions options;
  options.apply = false;
  const CameraMaskFinding finding = FindCameraMasks(WithPlate(), registration_, options).at(0);
  EXPECT_EQ(finding.status, CameraMaskStatus::kFound);
  EXPECT_FALSE(finding.applied);
}

TEST(AutoMaskOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<AutoMaskOptions>().RefusesBadRun();
  OptionTable<MovingPairOptions>()
      .Refuses("pairs", &MovingPairOptions::pairs, {0})
      .Refuses("min_motion", &MovingPairOptions::min_motion, {0.0, 0.8})
      .Refuses("max_motion", &MovingPairOptions::max_motion, {1.1})
      .Refuses("max_gap", &MovingPairOptions::max_gap, {0})
      .Refuses("standing_px", &MovingPairOptions::standing_px, {0.0})
      .Refuses("search_share", &MovingPairOptions::search_share, {-0.1})
      .Refuses("search_m", &MovingPairOptions::search_m, {0.0})
      .Refuses("search_rad", &MovingPairOptions::search_rad, {0.0});
}

}  // namespace
}  // namespace floorloc
