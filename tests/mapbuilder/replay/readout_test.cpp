// SPDX-License-Identifier: Apache-2.0
// A camera that is read out row by row on a robot that drives at 1 m/s.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/diagnosis/readout_finding.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/replay/localize_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

constexpr double kReadoutS = 0.012;

// A map, and a drive whose rows are read out one after the other, made once.
class ReadoutReplayTest : public ::testing::Test {
 protected:
  static const std::filesystem::path& Folder() {
    static const TemporaryFolder folder;
    static const bool made = [] {
      SimulateOptions survey = SyntheticFloor(5).SurveyOptions(folder.path() / "survey");
      Simulate(survey);
      BuildOptions build;
      build.surveys = {survey.out};
      build.out = folder.path() / "floor.floormap";
      build.hold_out = false;
      BuildMap(build);
      SimulateOptions drive = SyntheticFloor(5).SurveyOptions(folder.path() / "drive");
      drive.path.type = PathType::kDrive;
      drive.path.frames = 30;
      drive.path.fps = 5.0;
      drive.path.speed_m_per_s = 1.0;
      drive.path.odometry_rate_hz = 50.0;
      drive.conditions.readout_s = kReadoutS;
      drive.seed = 7;
      Simulate(drive);
      return true;
    }();
    EXPECT_TRUE(made);
    return folder.path();
  }

  FusedDrive Track(std::optional<double> readout_s) {
    drive_.camera.camera.readout.seconds = readout_s;
    return FuseFrames(localizer_, drive_, FuseFramesOptions());
  }

  // The map's frame is that of its first frame: relative motions over a second have no such offset.
  double MedianStepError(const FusedDrive& fused) const {
    std::vector<LocalizedFrame> frames;
    for (const FusedFrame& frame : fused.frames) {
      frames.push_back(frame.localized);
    }
    return MedianStepError(frames);
  }
  double MedianStepError(const std::vector<LocalizedFrame>& frames) const {
    constexpr std::size_t kStep = 5;
    std::vector<double> errors;
    for (std::size_t i = kStep; i < frames.size(); ++i) {
      const LocalizedFrame& a = frames[i - kStep];
      const LocalizedFrame& b = frames[i];
      if (a.result.status == LocalizationStatus::kLocalized && b.result.status == LocalizationStatus::kLocalized) {
        const Pose2 truth = InterpolatePose(drive_.ground_truth, a.frame.stamp_ns)
                                ->Between(*InterpolatePose(drive_.ground_truth, b.frame.stamp_ns));
        errors.push_back(
            (a.result.map_from_base.Between(b.result.map_from_base).translation() - truth.translation()).norm());
      }
    }
    EXPECT_GT(errors.size(), 10U);
    std::sort(errors.begin(), errors.end());
    return errors.empty() ? 1.0 : errors[errors.size() / 2];
  }

  MapDatabase database_{Folder() / "floor.floormap"};
  Localizer localizer_{database_.ReadMap(), {}, [this](const TileId& tile) { return database_.ReadMosaicTile(tile); }};
  Survey drive_ = ReadSurvey(Folder() / "drive");
};

TEST_F(ReadoutReplayTest, AGivenReadoutIsCompensated) {
  const double compensated_m = MedianStepError(Track(kReadoutS));
  EXPECT_LT(compensated_m, 0.0015);
  EXPECT_GT(MedianStepError(Track(0.0)), 2.0 * compensated_m) << "a camera that claims a global shutter";
}

TEST_F(ReadoutReplayTest, AnUnknownReadoutIsLearntAndNamed) {
  const FusedDrive fused = Track(std::nullopt);
  EXPECT_LT(MedianStepError(fused), 0.002);
  ASSERT_TRUE(fused.camera.readout);
  EXPECT_NEAR(fused.camera.readout->seconds, kReadoutS, 0.001);
  const std::vector<Finding> findings = FindingsOfReadout(drive_.camera.camera.readout, fused.camera.readout);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].status, FindingStatus::kNote);
  EXPECT_THAT(findings[0].cure, HasSubstr("'readout_direction: down'"));
}

TEST_F(ReadoutReplayTest, FramesWithoutAPriorUseTheMotionToo) {
  EXPECT_LT(MedianStepError(LocalizeFrames(localizer_, drive_, {})), 0.002);
  drive_.odometry.clear();
  EXPECT_GT(MedianStepError(LocalizeFrames(localizer_, drive_, {})), 0.003) << "nothing tells how it moves";
}

TEST(ReadoutCheckTest, NamesTheDirectionThatTheRowsShow) {
  const auto finding = [](ReadoutDirection direction, double seconds) {
    Readout given;
    given.direction = direction;
    return FindingsOfReadout(given, ReadoutMeasurement{seconds, 2e-4}).at(0);
  };
  EXPECT_THAT(finding(ReadoutDirection::kDown, 0.021).sentence, HasSubstr("row by row in 21.0 +- 0.2 ms"));
  EXPECT_THAT(finding(ReadoutDirection::kDown, 0.021).cure, HasSubstr("'readout_s: 0.0210'"));
  EXPECT_THAT(finding(ReadoutDirection::kDown, -0.021).cure, HasSubstr("'readout_direction: up'"));
  EXPECT_THAT(finding(ReadoutDirection::kUp, -0.021).cure, HasSubstr("'readout_direction: down'"));
  EXPECT_THAT(finding(ReadoutDirection::kLeft, -0.021).cure, HasSubstr("'readout_direction: right'"));
  EXPECT_THAT(finding(ReadoutDirection::kRight, 0.021).sentence, HasSubstr("column by column"));
}

TEST(ReadoutCheckTest, WhatMayBeNoReadoutIsNoFinding) {
  for (const ReadoutMeasurement& learnt : {ReadoutMeasurement{0.0, 3e-4}, ReadoutMeasurement{-0.004, 2e-3}}) {
    const auto findings = FindingsOfReadout({}, learnt);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].status, FindingStatus::kOk);
    EXPECT_THAT(findings[0].sentence, HasSubstr("no read-out row by row was seen"));
  }
}

TEST(ReadoutCheckTest, SaysNothingOfWhatIsGivenOrNotSeen) {
  Readout given;
  EXPECT_TRUE(FindingsOfReadout(given, std::nullopt).empty());
  given.seconds = 0.02;
  EXPECT_TRUE(FindingsOfReadout(given, ReadoutMeasurement{0.03, 1e-4}).empty());
}

}  // namespace
}  // namespace floorloc
