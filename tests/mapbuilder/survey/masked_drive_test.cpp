// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/localization/localizer.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/replay/localize_frames.h"
#include "mapbuilder/replay/odometry_frames.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// A vehicle in whose every image a plate is in view that looks like the floor of another place: the worst that a part
// of the robot can look like.
class MaskedDriveTest : public ::testing::Test {
 protected:
  static constexpr int kFrames = 8;

  MaskedDriveTest() {
    floor_.WriteDrive(drive_, kFrames);
    const cv::Mat elsewhere = floor_.View(floor_.BaseForView(0.9, 0.6, 2.0));
    for (const auto& entry : std::filesystem::directory_iterator(drive_ / "images")) {
      cv::Mat image = cv::imread(entry.path().string());
      elsewhere(plate_).copyTo(image(plate_));
      cv::imwrite(entry.path().string(), image);
    }
  }

  cv::Mat PlateMask() const {
    cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
    mask(plate_).setTo(0);
    return mask;
  }
  void WriteMask() const { cv::imwrite((drive_ / "mask.png").string(), PlateMask()); }

  // Of views at known poses, so that the map is exact.
  Localizer MakeLocalizer(const cv::Mat& mask = cv::Mat()) const {
    FloorMap map;
    map.info.cameras = {ReadSurvey(drive_).camera};
    map.info.masks = {{mask, true, {}}};
    const auto extractor = CreateFeatureExtractor(map.info.extractor);
    const Rectifier rectifier(floor_.camera());
    for (const double x : {0.3, 0.6, 0.9}) {
      for (const double y : {0.3, 0.6}) {
        const Pose2 map_from_base = floor_.BaseForView(x, y, 0.0);
        cv::Mat gray;
        cv::cvtColor(floor_.View(map_from_base), gray, cv::COLOR_BGR2GRAY);
        AddTo(&map.keypoints, extractor->Extract(rectifier.Rectify(gray)), map_from_base);
      }
    }
    return {std::move(map), LocalizerOptions{}};
  }

  // What is new: a floor point that two views saw would be its own rival.
  static void AddTo(MapKeypoints* map, const Features& features, const Pose2& map_from_base) {
    const std::vector<Keypoint> before = map->keypoints;
    for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
      Keypoint keypoint = features.keypoints[i];
      const Eigen::Vector2d position = map_from_base * keypoint.Position();
      const bool known = std::any_of(before.begin(), before.end(), [&](const Keypoint& other) {
        return (other.Position() - position).norm() < 3e-3;
      });
      if (known) {
        continue;
      }
      keypoint.x_m = static_cast<float>(position.x());
      keypoint.y_m = static_cast<float>(position.y());
      keypoint.angle_rad = static_cast<float>(WrapAngle(keypoint.angle_rad + map_from_base.yaw()));
      map->keypoints.push_back(keypoint);
      map->descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
      map->observations.push_back(1);
      map->distinctiveness.push_back(255);
      map->last_survey.push_back(0);
    }
  }

  static bool IsRight(const LocalizedFrame& frame, const Survey& survey) {
    const std::optional<Pose2> truth = InterpolatePose(survey.ground_truth, frame.frame.stamp_ns);
    return frame.result.status == LocalizationStatus::kLocalized &&
           frame.result.map_from_base.Between(*truth).translation().norm() < 5e-3;
  }

  // Frames whose motion since the one before is off by more than 5 mm, or unknown.
  int WronglyTracked() const {
    const Survey survey = ReadSurvey(drive_);
    int wrong = 0;
    const std::vector<PlanarFrame> frames = TrackPlanarFrames(survey, {});
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const Pose2 truth = InterpolatePose(survey.ground_truth, frames[i - 1].frame.stamp_ns)
                              ->Between(*InterpolatePose(survey.ground_truth, frames[i].frame.stamp_ns));
      const auto& motion = frames[i].result.motion;
      wrong += motion && (motion->from_from_to.translation() - truth.translation()).norm() < 5e-3 ? 0 : 1;
    }
    return wrong;
  }

  SyntheticFloor floor_{1};
  TemporaryFolder folder_;
  std::filesystem::path drive_ = folder_.path() / "drive";
  cv::Rect plate_{0, 0, 380, 480};
};

TEST_F(MaskedDriveTest, LocalizingAndFusingGoWrongWithoutTheMaskAndRightWithIt) {
  const Localizer localizer = MakeLocalizer();
  const Survey unmasked = ReadSurvey(drive_);
  int confidently_wrong = 0;
  for (const LocalizedFrame& frame : LocalizeFrames(localizer, unmasked, {})) {
    const bool localized = frame.result.status == LocalizationStatus::kLocalized;
    confidently_wrong += localized && !IsRight(frame, unmasked) ? 1 : 0;
  }
  EXPECT_GT(confidently_wrong, kFrames / 2);
  WriteMask();
  const Survey masked = ReadSurvey(drive_);
  for (const LocalizedFrame& frame : LocalizeFrames(localizer, masked, {})) {
    EXPECT_TRUE(IsRight(frame, masked)) << ToJsonLine(frame);
  }
  for (const FusedFrame& frame : FuseFrames(localizer, masked, {}).frames) {
    EXPECT_TRUE(IsRight(frame.localized, masked)) << ToJsonLine(frame);
  }
}

TEST_F(MaskedDriveTest, ADriveWithoutAMaskGetsTheMapsOfItsCamera) {
  const Localizer localizer = MakeLocalizer(PlateMask());
  const Survey survey = ReadSurvey(drive_);
  ASSERT_TRUE(survey.mask.empty());
  for (const LocalizedFrame& frame : LocalizeFrames(localizer, survey, {})) {
    EXPECT_TRUE(IsRight(frame, survey)) << ToJsonLine(frame);
  }
  for (const FusedFrame& frame : FuseFrames(localizer, survey, {}).frames) {
    EXPECT_TRUE(IsRight(frame.localized, survey)) << ToJsonLine(frame);
  }
  cv::imwrite((drive_ / "mask.png").string(), cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
  const Survey declines = ReadSurvey(drive_);
  int wrong = 0;
  for (const LocalizedFrame& frame : LocalizeFrames(localizer, declines, {})) {
    wrong += IsRight(frame, declines) ? 0 : 1;
  }
  EXPECT_GT(wrong, kFrames / 2);
}

TEST_F(MaskedDriveTest, OdometryTakesThePlateForTheFloorUnlessItIsMasked) {
  EXPECT_GT(WronglyTracked(), kFrames / 2);
  WriteMask();
  EXPECT_EQ(WronglyTracked(), 0);
}

}  // namespace
}  // namespace floorloc
