// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/input_error.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/survey/extract_frames.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

const cv::Scalar kBodyColor(20, 20, 230);

// A survey whose images all show the same red, spotted part of the robot at the left edge.
class FloorMaskTest : public ::testing::Test {
 protected:
  FloorMaskTest() {
    const int frames = SyntheticFloor(1).WriteSurvey(survey_).frames;
    EXPECT_GT(frames, 0);
    for (const auto& entry : std::filesystem::directory_iterator(survey_ / "images")) {
      cv::Mat image = cv::imread(entry.path().string());
      image(body_).setTo(kBodyColor);
      for (int y = 12; y < body_.height; y += 24) {
        for (int x = 12; x < body_.width - 8; x += 24) {
          cv::circle(image, {x, y}, 4, cv::Scalar::all(255), cv::FILLED);
        }
      }
      cv::imwrite(entry.path().string(), image);
    }
  }

  void WriteMask(const cv::Size& size) const {
    cv::Mat mask(size, CV_8UC1, cv::Scalar(255));
    mask(body_ & cv::Rect(cv::Point(), size)).setTo(0);
    cv::imwrite((survey_ / "mask.png").string(), mask);
  }

  static int RedPixels(const cv::Mat& bgr) {
    cv::Mat red;
    cv::inRange(bgr, cv::Scalar(0, 0, 100), cv::Scalar(60, 60, 255), red);
    return cv::countNonZero(red);
  }

  TemporaryFolder folder_;
  std::filesystem::path survey_ = folder_.path() / "survey";
  cv::Rect body_{0, 0, 140, 480};
};

TEST_F(FloorMaskTest, WhatIsMaskedIsNeitherInTheMosaicNorAmongTheKeypoints) {
  WriteMask({640, 480});
  const std::vector<LoadedSurvey> surveys = LoadSurveys({survey_});
  const std::vector<BuildFrame> frames = ExtractSurveyFrames(surveys, {});
  int keypoints = 0;
  for (const BuildFrame& frame : frames) {
    for (const Keypoint& keypoint : frame.features.keypoints) {
      const Eigen::Vector2d raw = surveys[0].survey.camera.RawPixelFromFloor({keypoint.x_m, keypoint.y_m});
      EXPECT_GT(raw.x(), body_.width - 1.0);
      ++keypoints;
    }
  }
  EXPECT_GT(keypoints, 1000);
  BuildOptions options;
  options.surveys = {survey_};
  options.out = folder_.path() / "floor.floormap";
  options.mosaic.resolution_m = 0.0028;
  const BuildReport report = BuildMap(options);
  EXPECT_EQ(report.frames_used, 28);
  const cv::Mat mosaic = ExportMosaic(MapDatabase(options.out), 0.0).bgr;
  EXPECT_EQ(RedPixels(mosaic), 0);
}

TEST_F(FloorMaskTest, WhatMovesWithTheCameraIsFoundByItself) {
  BuildOptions options;
  options.surveys = {survey_};
  options.out = folder_.path() / "floor.floormap";
  options.mosaic.resolution_m = 0.0028;
  options.hold_out = false;
  const BuildReport report = BuildMap(options);
  ASSERT_EQ(report.masks.size(), 1U);
  EXPECT_EQ(report.masks[0].status, CameraMaskStatus::kFound);
  EXPECT_NEAR(report.masks[0].share, 140.0 / 640.0, 0.02);
  EXPECT_EQ(report.frames_used, 28);
  EXPECT_THAT(ToText(report), HasSubstr("moves with the camera; --mask FILE or --no-auto-mask overrules"));
  EXPECT_EQ(RedPixels(ExportMosaic(MapDatabase(options.out), 0.0).bgr), 0);
}

TEST_F(FloorMaskTest, WithoutAutoMaskItIsReported) {
  BuildOptions options;
  options.surveys = {survey_};
  options.out = folder_.path() / "floor.floormap";
  options.mosaic.resolution_m = 0.0028;
  options.hold_out = false;
  options.auto_mask.apply = false;
  const BuildReport report = BuildMap(options);
  EXPECT_THAT(AllWarnings(report), Contains(HasSubstr("moves with the camera, and is in the map")));
  EXPECT_GT(RedPixels(ExportMosaic(MapDatabase(options.out), 0.0).bgr), 20);
}

TEST_F(FloorMaskTest, AMaskForAllSurveysReplacesWhatIsFound) {
  cv::imwrite((folder_.path() / "all_floor.png").string(), cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
  BuildOptions options;
  options.surveys = {survey_};
  options.out = folder_.path() / "floor.floormap";
  options.mosaic.resolution_m = 0.0028;
  options.hold_out = false;
  options.mask = folder_.path() / "all_floor.png";
  const BuildReport report = BuildMap(options);
  EXPECT_EQ(report.masks.at(0).status, CameraMaskStatus::kGiven);
  EXPECT_EQ(report.masks.at(0).share, 0.0);
  EXPECT_GT(RedPixels(ExportMosaic(MapDatabase(options.out), 0.0).bgr), 20);
  cv::imwrite(options.mask.string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(255)));
  EXPECT_THROW(BuildMap(options), InputError);
}

TEST_F(FloorMaskTest, AMaskThatDoesNotFitIsRefused) {
  WriteMask({320, 240});
  EXPECT_THROW(LoadSurveys({survey_}), InputError);
  cv::imwrite((survey_ / "mask.png").string(), cv::Mat::zeros(480, 640, CV_8UC1));
  EXPECT_THROW(LoadSurveys({survey_}), InputError);
}

}  // namespace
}  // namespace floorloc
