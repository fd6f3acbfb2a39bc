// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/floor_calibration.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/geometry/floor_plane.h"
#include "core/io/input_error.h"
#include "mapbuilder/calibration/floor_region.h"
#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

const Board kBoard{9, 6, 0.02, {}};

// A camera 0.4 m above the floor and 0.1 m ahead of the base, looking forward and down.
Eigen::Isometry3d BaseFromCamera(double pitch_down_deg) {
  Eigen::Matrix3d forward;  // optical axis forward, v down
  forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.1, 0.02, 0.4;
  pose.linear() = Eigen::AngleAxisd(pitch_down_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()) * forward;
  return pose;
}

BoardOnFloorObservation ObserveBoard(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera,
                                     const Pose2& base_from_board, double height_m) {
  Eigen::Isometry3d board = Eigen::Isometry3d::Identity();
  board.translation() << base_from_board.x(), base_from_board.y(), height_m;
  board.rotate(Eigen::AngleAxisd(base_from_board.yaw(), Eigen::Vector3d::UnitZ()));
  const Eigen::Isometry3d camera_from_board = base_from_camera.inverse() * board;
  // The initial guess has the error of a single image's pose.
  return {"floor.jpg", ProjectBoard(camera, kBoard, camera_from_board, 0.03, 3), base_from_board,
          camera_from_board * Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX())};
}

double WorstFloorErrorM(const FloorCalibration& found, const CameraModel& camera,
                        const Eigen::Isometry3d& base_from_camera) {
  double worst = 0.0;
  for (double x = 0.25; x < 0.6; x += 0.05) {
    for (double y = -0.15; y < 0.16; y += 0.05) {
      const Eigen::Vector3d p = base_from_camera.inverse() * Eigen::Vector3d(x, y, 0.0);
      const Eigen::Vector2d px(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
      worst =
          std::max(worst, ((found.base_from_pixel * px.homogeneous()).hnormalized() - Eigen::Vector2d(x, y)).norm());
    }
  }
  return worst;
}

TEST(CalibrateFloor, FindsTheHomographyFromOneImage) {
  const CameraModel camera = MakeBoardCamera();
  const Eigen::Isometry3d pose = BaseFromCamera(55);
  const FloorCalibration found =
      CalibrateFloor({camera, kBoard, 0.0, {ObserveBoard(camera, pose, Pose2(0.33, -0.08, 0.2), 0.0)}});
  EXPECT_LT(WorstFloorErrorM(found, camera, pose), 2e-4);
  EXPECT_LT((found.base_from_camera.translation() - pose.translation()).norm(), 3e-4);
  EXPECT_NEAR(found.PitchDownRad(), 55 * std::numbers::pi / 180.0, 1e-3);
  EXPECT_LT(found.fits.front().rms_px, 0.06);
  EXPECT_LT(found.fits.front().rms_m, 1e-4);
}

TEST(CalibrateFloor, TakesTheThicknessOfTheBoardIntoAccount) {
  const CameraModel camera = MakeBoardCamera();
  const Eigen::Isometry3d pose = BaseFromCamera(50);
  FloorCalibrationInput input{camera, kBoard, 0.006, {ObserveBoard(camera, pose, Pose2(0.33, -0.08, 0.2), 0.006)}};
  EXPECT_LT(WorstFloorErrorM(CalibrateFloor(input), camera, pose), 2e-4);
  input.board_thickness_m = 0.0;
  EXPECT_GT(WorstFloorErrorM(CalibrateFloor(input), camera, pose), 2e-3);
}

TEST(CalibrateFloor, AveragesSeveralImagesAndSaysWhichDisagrees) {
  const CameraModel camera = MakeBoardCamera();
  const Eigen::Isometry3d pose = BaseFromCamera(60);
  FloorCalibrationInput input{camera, kBoard, 0.0, {}};
  for (const Pose2& board : {Pose2(0.28, -0.08, 0.2), Pose2(0.35, -0.02, 0.1), Pose2(0.3, -0.1, 0.5)}) {
    input.observations.push_back(ObserveBoard(camera, pose, board, 0.0));
  }
  EXPECT_LT(WorstFloorErrorM(CalibrateFloor(input), camera, pose), 2e-4);
  input.observations[1].base_from_board = Pose2(0.36, -0.02, 0.1);  // 1 cm off
  const FloorCalibration found = CalibrateFloor(input);
  EXPECT_GT(found.fits[1].rms_m, 3e-3);
  EXPECT_GT(found.fits[1].rms_m, found.fits[0].rms_m);
  EXPECT_GT(found.fits[1].rms_m, found.fits[2].rms_m);
}

Eigen::Matrix3d Homography(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Isometry3d inverse = base_from_camera.inverse();
  Eigen::Matrix3d columns;
  columns << inverse.linear().leftCols<2>(), inverse.translation();
  return (k * columns).inverse();
}

TEST(ChooseFloorRegion, TakesWhatADownwardCameraSees) {
  const CameraModel camera = MakeBoardCamera();
  const FloorPlane floor = ChooseFloorRegion(camera, Homography(camera, BaseFromCamera(90)), {});
  // At 0.4 m above the floor: 0.4 / 440 = 0.9 mm per pixel at the centre, more outside.
  EXPECT_DOUBLE_EQ(floor.resolution_m, 0.001);
  EXPECT_GT(floor.roi.width_m() * floor.roi.height_m(), 0.9 * 480 * 360 * 0.0009 * 0.0009);
  for (const double x : {floor.roi.x_min, floor.roi.x_max}) {
    for (const double y : {floor.roi.y_min, floor.roi.y_max}) {
      EXPECT_TRUE(camera.Contains((FloorCamera{camera, floor}.RawPixelFromFloor({x, y}))));
    }
  }
}

TEST(ChooseFloorRegion, StaysBelowTheHorizonAndWherePixelsAreFine) {
  const CameraModel camera = MakeBoardCamera();
  const FloorPlane floor = ChooseFloorRegion(camera, Homography(camera, BaseFromCamera(15)), {});
  EXPECT_GT(floor.roi.x_min, 0.1);
  EXPECT_LT(floor.roi.x_max, 3.0);
  EXPECT_NO_THROW((FloorCamera{camera, floor}.Check()));
}

TEST(ChooseFloorRegion, StaysWhereTheLensWasCalibrated) {
  const CameraModel camera = MakeBoardCamera();
  FloorRegionOptions options;
  options.max_radius_px = 150;
  const FloorPlane floor = ChooseFloorRegion(camera, Homography(camera, BaseFromCamera(90)), options);
  const Eigen::Vector2d px = FloorCamera{camera, floor}.RawPixelFromFloor({floor.roi.x_max, floor.roi.y_max});
  EXPECT_LT((px - Eigen::Vector2d(camera.cx, camera.cy)).norm(), 151);
}

TEST(ChooseFloorRegion, TakesAGivenRegionOrRefusesIt) {
  const CameraModel camera = MakeBoardCamera();
  const Eigen::Matrix3d homography = Homography(camera, BaseFromCamera(90));
  FloorRegionOptions options;
  options.roi = RectM{0.0, 0.2, -0.1, 0.1};
  options.resolution_m = 0.001;
  EXPECT_EQ(ChooseFloorRegion(camera, homography, options).roi.x_max, 0.2);
  EXPECT_EQ(ChooseFloorRegion(camera, homography, options).resolution_m, 0.001);
  options.roi = RectM{5.0, 5.2, -0.1, 0.1};
  EXPECT_THROW(ChooseFloorRegion(camera, homography, options), InputError);
  options.roi = RectM{0.2, 0.0, -0.1, 0.1};
  EXPECT_THROW(ChooseFloorRegion(camera, homography, options), InputError);
}

}  // namespace
}  // namespace floorloc
