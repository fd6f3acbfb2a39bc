// SPDX-License-Identifier: Apache-2.0
// A vehicle learns from its fixes that its camera was bumped since it was calibrated.
#include <gtest/gtest.h>

#include <numbers>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A map of a synthetic floor, made once.
class CameraEstimateTest : public ::testing::Test {
 protected:
  static const std::filesystem::path& Map() {
    static const TemporaryFolder folder;
    static const std::filesystem::path map = [] {
      SimulateOptions options = SyntheticFloor(3).SurveyOptions(folder.path() / "survey");
      Simulate(options);
      BuildOptions build;
      build.surveys = {options.out};
      build.out = folder.path() / "floor.floormap";
      build.hold_out = false;
      BuildMap(build);
      return build.out;
    }();
    return map;
  }

  FusedDrive Drive(const CalibrationError& error) const {
    SimulateOptions options = SyntheticFloor(3).SurveyOptions(folder_.path() / "drive");
    options.calibration_error = error;
    options.path.type = PathType::kDrive;
    options.path.frames = 60;
    options.seed = 2;
    Simulate(options);
    const MapDatabase database(Map());
    const Localizer localizer(database.ReadMap(), {},
                              [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
    return FuseFrames(localizer, ReadSurvey(folder_.path() / "drive"), FuseFramesOptions());
  }

  TemporaryFolder folder_;
};

TEST_F(CameraEstimateTest, ABumpedCameraIsNoticedAndCorrected) {
  const FusedDrive drive = Drive({.roll_rad = 1.2 * kDegree, .pitch_rad = -0.8 * kDegree});
  ASSERT_EQ(drive.camera.status, CameraStatus::kCorrected) << drive.camera.fixes << " fixes";
  // The calibration is off by the error: the camera by its opposite.
  EXPECT_NEAR(drive.camera.errors.mean(0), -1.2 * kDegree, 0.35 * kDegree);
  EXPECT_NEAR(drive.camera.errors.mean(1), 0.8 * kDegree, 0.35 * kDegree);
  EXPECT_GT(drive.camera_off_px, 1.0);
}

TEST_F(CameraEstimateTest, TheSurveysCameraIsAsCalibrated) {
  const FusedDrive drive = Drive({});
  ASSERT_EQ(drive.camera.status, CameraStatus::kAsCalibrated) << drive.camera.fixes << " fixes";
  EXPECT_LT(drive.camera_off_px, 0.5);
}

}  // namespace
}  // namespace floorloc
