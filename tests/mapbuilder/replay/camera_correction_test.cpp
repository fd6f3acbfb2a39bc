// SPDX-License-Identifier: Apache-2.0
#include "core/map/camera_correction.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "core/map/map_database.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/localize_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// A survey and a drive with one camera, whose calibration is wrong as calibrations are: a pixel at the image's corner,
// half a degree in the homography.
class ReplayedCorrectionTest : public ::testing::Test {
 protected:
  ReplayedCorrectionTest() {
    SimulateOptions options = floor_.SurveyOptions(folder_.path() / "survey");
    options.calibration_error = CalibrationError::Typical(1.0, 0.5 * std::numbers::pi / 180.0);
    Simulate(options);
    options.out = folder_.path() / "drive";
    options.path.type = PathType::kRandom;  // all headings
    options.path.frames = 25;
    options.seed = 2;
    Simulate(options);
    BuildOptions build;
    build.surveys = {folder_.path() / "survey"};
    build.out = folder_.path() / "floor.floormap";
    build.hold_out = false;
    BuildMap(build);
    drive_ = ReadSurvey(folder_.path() / "drive");
  }

  // RMS error of the view's centre after the best rigid alignment, metres. Another place of the base, as the
  // homography's error makes it, turns with the frames, so the alignment does not take it up.
  double ErrorM(const std::vector<LocalizedFrame>& frames) const {
    const Eigen::Vector2d center = drive_.camera.floor.roi.Center();
    std::vector<OrientedMatch> pairs;
    for (const LocalizedFrame& frame : frames) {
      const std::optional<Pose2> truth = InterpolatePose(drive_.ground_truth, frame.frame.stamp_ns);
      if (truth && frame.result.status == LocalizationStatus::kLocalized) {
        pairs.push_back({frame.result.map_from_base * center, *truth * center, 0.0, 0.0});
      }
    }
    EXPECT_GT(pairs.size(), 20U);
    std::vector<int> all(pairs.size());
    std::iota(all.begin(), all.end(), 0);
    return RmsResidual(pairs, all, FitRigid(pairs, all).value());
  }

  SyntheticFloor floor_{3};
  TemporaryFolder folder_;
  Survey drive_;
};

TEST_F(ReplayedCorrectionTest, ADriveWithTheSurveysCameraGetsTheMaps) {
  const MapDatabase database(folder_.path() / "floor.floormap");
  const Localizer localizer(database.ReadMap(), {}, [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  const MapInfo& info = localizer.map().info;
  const std::optional<CameraCorrection> correction = CorrectCamera(info, drive_.camera);
  ASSERT_TRUE(correction);
  EXPECT_GT(correction->moved_px, 0.5);
  LocalizeFramesOptions options;
  const double corrected_m = ErrorM(LocalizeFrames(localizer, drive_, options));
  options.correct_camera = false;
  const double given_m = ErrorM(LocalizeFrames(localizer, drive_, options));
  EXPECT_LT(corrected_m, 5e-4);
  EXPECT_GT(given_m, 2.0 * corrected_m);
}

}  // namespace
}  // namespace floorloc
