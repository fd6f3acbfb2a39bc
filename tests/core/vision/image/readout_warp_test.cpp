// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/readout_warp.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {
namespace {

// Looks down at the floor from 0.42 m, a little askew.
FloorCamera MakeCamera(ReadoutDirection direction) {
  FloorCamera camera;
  camera.camera = {
      "test", 640, 480, 601.0, 598.0, 322.5, 236.0, DistortionModel::kPlumbBob, {-0.24, 0.07, 1e-3, -8e-4}};
  camera.camera.readout.direction = direction;
  camera.floor.base_from_pixel << 0.0, -0.0007, 0.36, -0.0007, 0.0, 0.2155, 4e-5, 6e-5, 1.0;
  camera.floor.roi = {0.06, 0.33, -0.19, 0.2};
  camera.floor.resolution_m = 0.0007;
  camera.Check();
  return camera;
}

const Eigen::Vector3d kMotion(0.033, -0.004, 0.02);  // 1 m/s for 33 ms

Eigen::Vector2d PixelOf(const PixelMap& map, int u, int v) {
  const cv::Vec2s whole = map.xy.at<cv::Vec2s>(v, u);
  const int index = map.fraction.at<std::uint16_t>(v, u);
  return {whole[0] + (index % cv::INTER_TAB_SIZE) / static_cast<double>(cv::INTER_TAB_SIZE),
          whole[1] + (index / cv::INTER_TAB_SIZE) / static_cast<double>(cv::INTER_TAB_SIZE)};
}

class ReadoutWarpTest : public ::testing::TestWithParam<ReadoutDirection> {
 protected:
  const FloorCamera camera_ = MakeCamera(GetParam());
  const GroundGrid grid_ = GroundGrid::FromFloor(camera_.floor);
};

// The law: the pixel sees the point from where the base is when the pixel's row is exposed.
TEST_P(ReadoutWarpTest, APointIsSeenWhenItsRowIsExposed) {
  for (const double x : {0.08, 0.2, 0.31}) {
    for (const double y : {-0.15, 0.02, 0.17}) {
      const Eigen::Vector2d raw = RawPixelWhileMoving(camera_, {x, y}, kMotion);
      const Pose2 middle_from_then = Pose2::Exp(ReadoutShare(camera_.camera, raw) * kMotion);
      EXPECT_LT((middle_from_then * camera_.FloorFromRawPixel(raw) - Eigen::Vector2d(x, y)).norm(), 2e-6);
      EXPECT_LT((FloorWhileMoving(camera_, raw, kMotion) - Eigen::Vector2d(x, y)).norm(), 2e-6);
    }
  }
}

TEST_P(ReadoutWarpTest, TheMapIsExactBetweenItsNodes) {
  PixelMap at_rest{cv::Mat(grid_.height_px, grid_.width_px, CV_16SC2),
                   cv::Mat(grid_.height_px, grid_.width_px, CV_16UC1)};
  cv::Mat exact(grid_.height_px, grid_.width_px, CV_32FC2);
  for (int v = 0; v < grid_.height_px; ++v) {
    for (int u = 0; u < grid_.width_px; ++u) {
      const Eigen::Vector2f raw = camera_.RawPixelFromFloor(grid_.BaseFromPixel(u, v)).cast<float>();
      exact.at<cv::Vec2f>(v, u) =
          camera_.camera.Contains(raw.cast<double>()) ? cv::Vec2f(raw.x(), raw.y()) : cv::Vec2f(-2.0F, -2.0F);
    }
  }
  cv::convertMaps(exact, cv::noArray(), at_rest.xy, at_rest.fraction, CV_16SC2);
  const PixelMap moved = MoveRows(camera_, grid_, at_rest, kMotion);
  double worst_px = 0.0;
  for (int v = 0; v < grid_.height_px; v += 3) {
    for (int u = 0; u < grid_.width_px; u += 3) {
      if (moved.xy.at<cv::Vec2s>(v, u)[0] >= 0) {
        const Eigen::Vector2d expected = RawPixelWhileMoving(camera_, grid_.BaseFromPixel(u, v), kMotion);
        worst_px = std::max(worst_px, (PixelOf(moved, u, v) - expected).cwiseAbs().maxCoeff());
      }
    }
  }
  EXPECT_LT(worst_px, 0.05) << "two roundings to 1/32 px";
}

INSTANTIATE_TEST_SUITE_P(Directions, ReadoutWarpTest,
                         ::testing::Values(ReadoutDirection::kDown, ReadoutDirection::kUp, ReadoutDirection::kRight,
                                           ReadoutDirection::kLeft));

TEST(ReadoutShareTest, TheMiddleRowIsTheTimeOfTheImage) {
  const CameraModel down = MakeCamera(ReadoutDirection::kDown).camera;
  const CameraModel up = MakeCamera(ReadoutDirection::kUp).camera;
  EXPECT_EQ(ReadoutShare(down, {0.0, 239.5}), 0.0);
  EXPECT_NEAR(ReadoutShare(down, {0.0, 0.0}), -0.5, 0.5 / 480.0 + 1e-12);
  EXPECT_EQ(ReadoutShare(up, {10.0, 100.0}), -ReadoutShare(down, {10.0, 100.0}));
  EXPECT_EQ(ReadoutShare(MakeCamera(ReadoutDirection::kRight).camera, {319.5, 0.0}), 0.0);
}

// What leaves the image is not floor, and the robot's body moves with the camera: its pixels stay its own.
TEST(ReadoutMaskTest, AMovingCamerasMaskFollowsItsRows) {
  const FloorCamera camera = MakeCamera(ReadoutDirection::kDown);
  cv::Mat raw_mask(480, 640, CV_8UC1, cv::Scalar(255));
  raw_mask(cv::Rect(0, 0, 640, 60)).setTo(0);
  cv::Mat raw(480, 640, CV_8UC1, cv::Scalar(100));
  raw(cv::Rect(0, 0, 640, 60)).setTo(250);
  const Rectifier rectifier(camera, raw_mask);
  const GroundImage image = rectifier.Rectify(raw, kMotion);
  EXPECT_NE(cv::norm(image.mask, rectifier.mask()), 0.0);
  double brightest = 0.0;
  cv::minMaxLoc(image.gray, nullptr, &brightest);
  EXPECT_EQ(brightest, 100.0);
  EXPECT_EQ(cv::countNonZero(image.gray), cv::countNonZero(image.mask));
  const GroundImage at_rest = rectifier.Rectify(raw, Eigen::Vector3d::Zero());
  EXPECT_EQ(cv::norm(at_rest.mask, rectifier.mask()), 0.0);
}

}  // namespace
}  // namespace floorloc
