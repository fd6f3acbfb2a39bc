// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/constraint_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Board kBoard{9, 6, 0.02, {}};

std::vector<Diagnostic> DiagnosticsOf(const std::vector<BoardPlacement>& placements) {
  const CameraModel camera = MakeBoardCamera();
  CameraCalibrationInput input{kBoard, camera.width_px, camera.height_px, {}};
  for (const BoardPlacement& placement : placements) {
    const auto seed = static_cast<unsigned>(input.views.size());
    const Eigen::Isometry3d pose = PlaceBoard(camera, kBoard, placement);
    input.views.push_back({"image", ProjectBoard(camera, kBoard, pose, 0.05, seed)});
  }
  return CheckConstraints(input, CalibrateCamera(input, {}));
}

std::string Fatal(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    text += diagnostic.fatal ? diagnostic.sentence + "\n" : "";
  }
  return text;
}

std::string All(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    text += diagnostic.sentence + "\n";
  }
  return text;
}

std::vector<BoardPlacement> Good(int count = 18) { return VariedPlacements(MakeBoardCamera(), kBoard, count); }

TEST(CheckConstraints, GoodImagesHaveNoDiagnostics) { EXPECT_THAT(All(DiagnosticsOf(Good())), IsEmpty()); }

TEST(CheckConstraints, RefusesBoardsThatAreNotTilted) {
  std::vector<BoardPlacement> flat = Good();
  for (BoardPlacement& placement : flat) {
    placement.tilt_x_rad = placement.tilt_y_rad = 0.0;
  }
  EXPECT_THAT(Fatal(DiagnosticsOf(flat)), HasSubstr("tilted by 20 to 45 degrees"));
}

TEST(CheckConstraints, WarnsOfBoardsThatAreHardlyTilted) {
  std::vector<BoardPlacement> flat = Good();
  for (BoardPlacement& placement : flat) {
    placement.tilt_x_rad *= 0.2;
    placement.tilt_y_rad *= 0.2;
  }
  const std::vector<Diagnostic> diagnostics = DiagnosticsOf(flat);
  EXPECT_THAT(Fatal(diagnostics), IsEmpty());
  EXPECT_THAT(All(diagnostics), HasSubstr("tilted by no more than"));
}

TEST(CheckConstraints, RefusesBoardsOnlyInTheMiddle) {
  std::vector<BoardPlacement> middle = Good();
  for (BoardPlacement& placement : middle) {
    placement.middle_px = {240, 180};
    placement.distance_m *= 2.5;
  }
  EXPECT_THAT(Fatal(DiagnosticsOf(middle)), HasSubstr("only seen in the middle"));
}

TEST(CheckConstraints, NamesThePartOfTheImageWithoutBoards) {
  std::vector<BoardPlacement> left = Good();
  std::erase_if(left, [](const BoardPlacement& placement) { return placement.middle_px.x() > 250; });
  for (BoardPlacement& placement : left) {
    placement.middle_px.x() = std::min(placement.middle_px.x(), 150.0);
  }
  const std::string text = All(DiagnosticsOf(left));
  EXPECT_THAT(text, HasSubstr("the upper right"));
  EXPECT_THAT(text, HasSubstr("the lower right"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("left")));
}

TEST(CheckConstraints, WarnsOfFewImages) { EXPECT_THAT(All(DiagnosticsOf(Good(6))), HasSubstr("only 6 images")); }

TEST(CheckConstraints, SaysThatOneDistanceIsNotEnough) {
  std::vector<BoardPlacement> same;
  for (int i = 0; i < 9; ++i) {
    const BoardPlacement varied = Good()[static_cast<std::size_t>(i)];
    same.push_back({varied.middle_px, 3.0, 0.3 * varied.tilt_x_rad, 0.3 * varied.tilt_y_rad, 0.0});
  }
  EXPECT_THAT(All(DiagnosticsOf(same)), HasSubstr("equally far away"));
}

TEST(CalibratedRadiusPx, IsTheFarthestCornersDistance) {
  CameraCalibrationInput input{kBoard, 480, 360, {{"one", {{0, 1}, {{100, 100}, {240, 200}}}}}};
  CameraCalibration calibration;
  calibration.camera.cx = 240;
  calibration.camera.cy = 180;
  calibration.views.push_back({"one", true, Eigen::Isometry3d::Identity(), 0.0, 0.0});
  EXPECT_NEAR(CalibratedRadiusPx(input, calibration), std::hypot(140, 80), 1e-9);
  calibration.views[0].used = false;
  EXPECT_EQ(CalibratedRadiusPx(input, calibration), 0.0);
}

}  // namespace
}  // namespace floorloc
