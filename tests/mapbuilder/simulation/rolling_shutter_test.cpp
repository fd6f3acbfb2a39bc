// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/vision/image/rectifier.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "mapbuilder/simulation/render_conditions.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

// Structures of a few pixels: no two rows look alike.
FloorTexture NoisyFloor() {
  FloorTexture floor;
  floor.resolution_m = 0.001;
  floor.bgr.create(1200, 1200, CV_8UC3);
  cv::RNG rng(7);
  rng.fill(floor.bgr, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(floor.bgr, floor.bgr, {}, 2.0);
  return floor;
}

double RowDifference(const cv::Mat& a, const cv::Mat& b, int row) {
  return cv::norm(a.row(row), b.row(row), cv::NORM_L2) / std::sqrt(static_cast<double>(a.cols));
}

class RollingShutterTest : public ::testing::Test {
 protected:
  const FloorCamera camera_ = MakeDownwardCamera();
  const CameraRenderer renderer_{NoisyFloor(), camera_};
  const Pose2 pose_{0.4, 0.55, 0.4};
  const Eigen::Vector3d readout_motion_{0.008, 0.003, 0.02};
};

TEST_F(RollingShutterTest, EveryRowIsSeenFromWhereTheRobotIsByThen) {
  RenderConditions conditions;
  conditions.motion = 0.3 * readout_motion_;
  RenderConditions rolling = conditions;
  rolling.readout_motion = readout_motion_;
  const cv::Mat image = renderer_.Render(pose_, rolling);
  for (const int row : {0, 100, 239, 333, 479}) {
    const Pose2 then = pose_ * Pose2::Exp(((row + 0.5) / 480.0 - 0.5) * readout_motion_);
    EXPECT_LT(RowDifference(image, renderer_.Render(then, conditions), row), 1e-9) << "row " << row;
  }
}

TEST_F(RollingShutterTest, ThePoseOfTheImageIsThatOfItsMiddleRow) {
  RenderConditions rolling;
  rolling.readout_motion = readout_motion_;
  const cv::Mat image = renderer_.Render(pose_, rolling);
  const cv::Mat still = renderer_.Render(pose_, {});
  const double middle = 0.5 * (RowDifference(image, still, 239) + RowDifference(image, still, 240));
  EXPECT_LT(middle, 1.0);
  EXPECT_GT(RowDifference(image, still, 0), 20.0 * middle);
  EXPECT_GT(RowDifference(image, still, 479), 20.0 * middle);
}

// The law of the correction: rectified with the motion, the image is that of a global shutter.
TEST_F(RollingShutterTest, RectifyingPutsEveryRowWhereItBelongs) {
  const auto gray = [](const cv::Mat& bgr) {
    cv::Mat levels;
    cv::cvtColor(bgr, levels, cv::COLOR_BGR2GRAY);
    return levels;
  };
  const Eigen::Vector3d fast(0.033, 0.004, 0.02);  // 1 m/s for 33 ms
  RenderConditions rolling;
  rolling.readout_motion = fast;
  const cv::Mat image = gray(renderer_.Render(pose_, rolling));
  const Rectifier rectifier(camera_);
  const GroundImage still = rectifier.Rectify(gray(renderer_.Render(pose_, {})));
  const GroundImage corrected = rectifier.Rectify(image, fast);
  const double pixels = cv::countNonZero(corrected.mask);
  EXPECT_GT(pixels, 0.85 * cv::countNonZero(still.mask));
  const auto difference = [&](const GroundImage& other) {
    return cv::norm(still.gray, other.gray, cv::NORM_L1, corrected.mask) / pixels;
  };
  EXPECT_LT(difference(corrected), 2.0) << "grey levels";
  EXPECT_GT(difference(rectifier.Rectify(image)), 10.0 * difference(corrected));
}

TEST_F(RollingShutterTest, TheSamplerMovesTheRobotByItsTwist) {
  ConditionLevels levels = ConditionLevels::FromName("mild");
  const Eigen::Vector3d twist(0.3, -0.1, 0.5);
  const FloorTexture floor = NoisyFloor();
  EXPECT_TRUE(ConditionSampler(levels, floor, camera_, 1).Sample(0, 0.0, twist).readout_motion.isZero());
  levels.readout_s = 0.02;
  const ConditionSampler sampler(levels, floor, camera_, 1);
  EXPECT_LT((sampler.Sample(0, 0.0, twist).readout_motion - 0.02 * twist).norm(), 1e-12);
  EXPECT_TRUE(sampler.Sample(0, 0.0, Eigen::Vector3d::Zero()).readout_motion.isZero());
}

TEST_F(RollingShutterTest, AGlobalShutterIsTheDefault) {
  for (const char* name : {"clean", "mild", "hard"}) {
    EXPECT_EQ(ConditionLevels::FromName(name).readout_s, 0.0) << name;
  }
}

TEST_F(RollingShutterTest, RefusesReadoutTimesThatNoCameraHas) {
  for (const double readout_s : {-0.01, 0.3}) {
    ConditionLevels levels;
    levels.readout_s = readout_s;
    try {
      levels.Check();
      ADD_FAILURE() << "accepted " << readout_s;
    } catch (const std::invalid_argument& refused) {
      EXPECT_THAT(refused.what(), HasSubstr("rolling shutter must be 0 to 0.2 s"));
    }
  }
}

}  // namespace
}  // namespace floorloc
