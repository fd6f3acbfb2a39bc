// SPDX-License-Identifier: Apache-2.0
// On nearly alike tiles a worn floor's frames tell together where each of them alone does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

class TiledDriveTest : public ::testing::Test {
 protected:
  static SimulateOptions Options(const std::filesystem::path& out) {
    SimulateOptions options = SyntheticFloor(5).SurveyOptions(out);
    options.floor.source = "tiles";
    options.floor.width_m = 2.4;
    options.floor.height_m = 1.8;
    return options;
  }

  static const Localizer& TheLocalizer() {
    static const TemporaryFolder folder;
    static const std::unique_ptr<const Localizer> localizer = [] {
      Simulate(Options(folder.path() / "survey"));
      BuildOptions build;
      build.surveys = {folder.path() / "survey"};
      build.poses = ReadTum(folder.path() / "survey" / "groundtruth.tum");
      build.out = folder.path() / "floor.floormap";
      build.hold_out = false;
      BuildMap(build);
      static const MapDatabase database(build.out);
      return std::make_unique<const Localizer>(database.ReadMap(), LocalizerOptions{},
                                               [](const TileId& tile) { return database.ReadMosaicTile(tile); });
    }();
    return *localizer;
  }

  // A drive over the floor after 40 % of it were worn, under hard conditions.
  static const std::filesystem::path& Drive() {
    static const TemporaryFolder folder;
    static const std::filesystem::path drive = [] {
      SimulateOptions options = Options(folder.path() / "drive");
      options.path.type = PathType::kDrive;
      options.path.frames = 40;
      options.path.fps = 1.5;
      options.conditions = ConditionLevels::FromName("hard");
      options.wear = 0.4;
      options.seed = 7;
      Simulate(options);
      return options.out;
    }();
    return drive;
  }

  static double ErrorOf(const Pose2& pose, std::int64_t stamp_ns) {
    static const Trajectory truth = ReadTum(Drive() / "groundtruth.tum");
    const auto at = std::find_if(truth.begin(), truth.end(), [&](const auto& p) { return p.stamp_ns == stamp_ns; });
    return at == truth.end() ? 1e9 : (at->ToPose2().translation() - pose.translation()).norm();
  }
};

TEST_F(TiledDriveTest, FramesTogetherTellThePlace) {
  const FusedDrive drive = FuseFrames(TheLocalizer(), ReadSurvey(Drive()), {});
  int alone = 0;
  int by_drive = 0;
  int localized = 0;
  for (const FusedFrame& frame : drive.frames) {
    const LocalizationResult& result = frame.localized.result;
    alone += result.status == LocalizationStatus::kLocalized && !(result.lattice && result.lattice->by_prior) ? 1 : 0;
    by_drive += frame.outcome.by_drive ? 1 : 0;
    if (frame.pose && frame.pose->state == TrackingState::kLocalized) {
      ++localized;
      EXPECT_LT(ErrorOf(frame.pose->map_from_base, frame.localized.frame.stamp_ns), 0.01);
    }
  }
  EXPECT_GE(localized, 32) << alone << " frames alone, " << by_drive << " by the drive";
  EXPECT_GT(by_drive, 5);
}

TEST_F(TiledDriveTest, FramesThatDoNotTellTheirPlaceTellTheirPoseOnATile) {
  const Survey survey = ReadSurvey(Drive());
  FuseFramesOptions alone;
  alone.use_prior = false;
  int ambiguous = 0;
  for (const FusedFrame& frame : FuseFrames(TheLocalizer(), survey, alone).frames) {
    const LocalizationResult& result = frame.localized.result;
    if (result.status != LocalizationStatus::kAmbiguous || !result.lattice) {
      continue;
    }
    ++ambiguous;
    const LatticeObservation& seen = *result.lattice;
    EXPECT_NEAR(seen.lattice.basis.col(0).norm(), 0.3, 0.002);
    double least_m = 1e9;
    for (const LatticePlace& place : seen.places) {
      least_m = std::min(least_m, ErrorOf(place.map_from_base, frame.localized.frame.stamp_ns));
    }
    EXPECT_LT(least_m, 0.005);
  }
  EXPECT_GT(ambiguous, 3);
}

}  // namespace
}  // namespace floorloc
