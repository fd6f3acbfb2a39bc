// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/camera_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/geometry/mounting.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

class CameraAdjustmentTest : public ::testing::TestWithParam<FloorCamera> {};

INSTANTIATE_TEST_SUITE_P(Cameras, CameraAdjustmentTest,
                         ::testing::Values(MakeDownwardCamera(), MakeForwardCamera(), MakeEquidistantCamera()));

TEST_P(CameraAdjustmentTest, NoChangeIsNoChange) {
  const FloorCamera same = Adjusted(GetParam(), CameraAdjustment::Zero());
  const Eigen::Vector2d raw_px(100.0, 300.0);
  EXPECT_LT((same.FloorFromRawPixel(raw_px) - GetParam().FloorFromRawPixel(raw_px)).norm(), 1e-9);
}

// Agrees to first order with MountingJacobian, which was derived independently.
TEST_P(CameraAdjustmentTest, MountingMovesThePointsAsTheJacobianSays) {
  const FloorCamera& camera = GetParam();
  const Eigen::Vector2d point = camera.floor.roi.Center() + Eigen::Vector2d(0.07, -0.05);
  const Eigen::Matrix<double, 2, 4> mounting = MountingJacobian(camera.CameraCenter(), point);
  const Eigen::Matrix<double, 2, kCameraUnknowns> jacobian =
      AdjustmentDerivative(camera).At(camera.RawPixelFromFloor(point));
  EXPECT_LT((jacobian.col(0) - mounting.col(0)).norm(), 1e-5);
  EXPECT_LT((jacobian.col(1) - mounting.col(1)).norm(), 1e-5);
  EXPECT_LT((jacobian.col(2) - mounting.col(3)).norm(), 1e-5);
}

// For a camera that looks straight down, focal length and height are not separable.
TEST(CameraAdjustmentTest, FocalLengthAndHeightCancelStraightDown) {
  const FloorCamera camera = MakeDownwardCamera();
  CameraAdjustment change = CameraAdjustment::Zero();
  change[static_cast<int>(CameraUnknown::kFocal)] = 0.02;
  change[static_cast<int>(CameraUnknown::kHeight)] = 0.02;
  const FloorCamera other = Adjusted(camera, change);
  const Eigen::Vector2d undistorted_px(400.0, 200.0);
  const auto floor_point = [&](const FloorCamera& c) -> Eigen::Vector2d {
    return (c.floor.base_from_pixel * undistorted_px.homogeneous()).hnormalized();
  };
  EXPECT_LT((floor_point(other) - floor_point(camera)).norm(), 1e-9);
  EXPECT_NEAR(other.CameraCenter().z(), 1.02 * camera.CameraCenter().z(), 1e-9);
}

}  // namespace
}  // namespace floorloc
