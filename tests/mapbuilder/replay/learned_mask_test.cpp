// SPDX-License-Identifier: Apache-2.0
// A vehicle learns on its way what travels with its camera, and leaves it out.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

class LearnedMaskDriveTest : public ::testing::Test {
 protected:
  // A map of the floor without anything in view, made once.
  static const std::filesystem::path& Map() {
    static const TemporaryFolder folder;
    static const std::filesystem::path map = [] {
      SyntheticFloor(5).WriteSurvey(folder.path() / "survey");
      BuildOptions build;
      build.surveys = {folder.path() / "survey"};
      build.out = folder.path() / "floor.floormap";
      build.hold_out = false;
      BuildMap(build);
      return build.out;
    }();
    return map;
  }

  FusedDrive Drive(double part_share, const FuseFramesOptions& fuse = {}) const {
    SimulateOptions drive = SyntheticFloor(5).SurveyOptions(folder_.path() / "drive");
    drive.path.type = PathType::kDrive;
    drive.path.frames = 36;
    drive.conditions.overlay.share = part_share;
    drive.seed = 2;
    if (!std::filesystem::exists(drive.out)) {
      Simulate(drive);
    }
    const MapDatabase database(Map());
    const Localizer localizer(database.ReadMap(), {},
                              [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
    return FuseFrames(localizer, ReadSurvey(drive.out), fuse);
  }

  TemporaryFolder folder_;
};

TEST_F(LearnedMaskDriveTest, APartIsLeftOutOnTheWay) {
  const FusedDrive drive = Drive(0.13);
  EXPECT_EQ(drive.mask.status, LearnedMaskStatus::kLearnt) << drive.mask.pairs << " pairs";
  EXPECT_NEAR(drive.mask.share, 0.13, 0.05);
  const auto first = nlohmann::json::parse(ToJsonLine(drive.frames.front()));
  const auto last = nlohmann::json::parse(ToJsonLine(drive.frames.back()));
  EXPECT_EQ(first["learnt_mask_share"], 0.0);
  EXPECT_NEAR(last["learnt_mask_share"].get<double>(), drive.mask.share, 1e-9);
  EXPECT_EQ(drive.frames.back().localized.result.status, LocalizationStatus::kLocalized);
  FuseFramesOptions without;
  without.tracker.mask.apply = false;
  const FusedDrive all = Drive(0.13, without);
  EXPECT_TRUE(all.mask.left_out.empty());
  EXPECT_GT(all.frames.back().localized.result.keypoints, 0);
}

TEST_F(LearnedMaskDriveTest, NothingIsLeftOutOfACleanDrive) {
  const FusedDrive drive = Drive(0.0);
  EXPECT_EQ(drive.mask.status, LearnedMaskStatus::kNothing) << drive.mask.pairs << " pairs";
  for (const FusedFrame& frame : drive.frames) {
    EXPECT_EQ(frame.learnt_share, 0.0);
  }
}

}  // namespace
}  // namespace floorloc
