// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/gray_renderer.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "mapbuilder/simulation/camera_renderer.h"

namespace floorloc {
namespace {

// Structures of a few pixels, so that a shift of a tenth of a pixel is measurable.
FloorTexture MakeFloor() {
  FloorTexture floor;
  floor.resolution_m = 0.0005;
  floor.bgr.create(1600, 2000, CV_8UC3);
  cv::RNG rng(7);
  rng.fill(floor.bgr, cv::RNG::UNIFORM, 0, 256);
  cv::cvtColor(floor.bgr, floor.bgr, cv::COLOR_BGR2GRAY);
  cv::cvtColor(floor.bgr, floor.bgr, cv::COLOR_GRAY2BGR);
  cv::GaussianBlur(floor.bgr, floor.bgr, {}, 4.0);
  cv::normalize(floor.bgr, floor.bgr, 30, 220, cv::NORM_MINMAX);
  return floor;
}

class GrayRendererTest : public ::testing::Test {
 protected:
  // Grey values, RMS.
  double Difference(const Pose2& gray_pose, const RenderConditions& conditions) const {
    const FloorTexture floor = MakeFloor();
    GrayFloor gray_floor{{}, floor.resolution_m};
    cv::cvtColor(floor.bgr, gray_floor.gray, cv::COLOR_BGR2GRAY);
    cv::Mat exact;
    cv::cvtColor(CameraRenderer(floor, camera_).Render(pose_, conditions), exact, cv::COLOR_BGR2GRAY);
    const cv::Mat quick = GrayRenderer(camera_).Render(gray_floor, gray_pose, conditions, 100);
    return cv::norm(exact, quick, cv::NORM_L2) / std::sqrt(static_cast<double>(exact.total()));
  }

  const FloorCamera camera_ = MakeDownwardCamera();
  const Pose2 pose_{0.4, 0.38, 0.3};
};

TEST_F(GrayRendererTest, AgreesWithTheExactRenderer) {
  EXPECT_LT(Difference(pose_, {}), 1.0);
  const Pose2 beside(pose_.x() + 1e-4, pose_.y(), pose_.yaw());  // a seventh of a pixel
  EXPECT_GT(Difference(beside, {}), 1.5 * Difference(pose_, {}));
}

TEST_F(GrayRendererTest, AgreesUnderLightBlurAndVibration) {
  RenderConditions conditions;
  conditions.gain = 0.8;
  conditions.bias = 6.0;
  conditions.vignetting = 0.3;
  conditions.light_gradient = {0.1, -0.1};
  conditions.lamps = {{{0.5, 0.4}, 0.2, 0.4, false}};
  conditions.shadow = {0.4, 0.2, 0.1, 0.02, 0.4};
  conditions.motion = {0.012, 0.0, 0.004};
  conditions.defocus_px = 2.0;
  conditions.vibration = {0.004, -0.003, 0.002};
  EXPECT_LT(Difference(pose_, conditions), 1.5);
}

TEST_F(GrayRendererTest, AgreesWithARollingShutter) {
  RenderConditions rolling;
  rolling.motion = {0.002, 0.0, 0.001};
  rolling.readout_motion = {0.006, -0.002, 0.01};
  EXPECT_LT(Difference(pose_, rolling), 1.0);
}

}  // namespace
}  // namespace floorloc
