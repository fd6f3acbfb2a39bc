// SPDX-License-Identifier: Apache-2.0
#include "core/map/camera_correction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using testing_map::Correct;
using testing_map::MakeCamera;

class CameraCorrectionTest : public ::testing::TestWithParam<DistortionModel> {
 protected:
  CameraCorrectionTest() {
    info_.given_cameras = {given_, Other()};
    info_.cameras = info_.given_cameras;
    Correct(&info_.cameras[0]);
  }

  FloorCamera Other() const {
    FloorCamera other = given_;
    other.camera.fx += 10.0;
    return other;
  }
  bool Knows(const FloorCamera& camera) const { return CorrectCamera(info_, camera).has_value(); }

  FloorCamera given_ = MakeCamera(GetParam());
  MapInfo info_;
};

INSTANTIATE_TEST_SUITE_P(Lenses, CameraCorrectionTest,
                         ::testing::Values(DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial,
                                           DistortionModel::kEquidistant),
                         [](const auto& test) { return std::string(ToString(test.param)); });

TEST_P(CameraCorrectionTest, TheSurveysCameraIsCorrected) {
  const std::optional<CameraCorrection> correction = CorrectCamera(info_, given_);
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->survey, 0);
  EXPECT_EQ(correction->camera.camera.fx, info_.cameras[0].camera.fx);
  EXPECT_EQ(correction->camera.camera.distortion, info_.cameras[0].camera.distortion);
  EXPECT_EQ(correction->camera.camera.sigma_px, info_.cameras[0].camera.sigma_px);
  EXPECT_EQ(correction->camera.floor.base_from_pixel, info_.cameras[0].floor.base_from_pixel);
  EXPECT_EQ(correction->camera.floor.offset_sigma_m, info_.cameras[0].floor.offset_sigma_m);
  EXPECT_EQ(CorrectedOrGiven(info_, given_).camera.fx, info_.cameras[0].camera.fx);
}

TEST_P(CameraCorrectionTest, NameRegionAndResolutionAreItsOwn) {
  FloorCamera camera = given_;
  camera.camera.name = "left";
  camera.floor.roi = {0.15, 0.25, -0.1, 0.1};
  camera.floor.resolution_m = 0.001;
  const std::optional<CameraCorrection> correction = CorrectCamera(info_, camera);
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->camera.camera.name, "left");
  EXPECT_EQ(correction->camera.floor.roi.x_min, 0.15);
  EXPECT_EQ(correction->camera.floor.roi.y_max, 0.1);
  EXPECT_EQ(correction->camera.floor.resolution_m, 0.001);
}

// Files with fewer digits, another scale of the homography, what the calibration is worth: the same calibration.
TEST_P(CameraCorrectionTest, HowItIsWrittenDoesNotMatter) {
  FloorCamera camera = given_;
  camera.camera.fx *= 1.0 + 1e-9;
  camera.camera.distortion[0] += 1e-9;
  camera.floor.base_from_pixel *= -3.0;
  camera.camera.sigma_px = 0.5;
  camera.floor.offset_sigma_m = 0.001;
  EXPECT_TRUE(Knows(camera));
}

TEST_P(CameraCorrectionTest, AnotherCalibrationIsNotKnown) {
  const auto changed = [&](auto change) {
    FloorCamera camera = given_;
    change(camera);
    return camera;
  };
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.fx += 0.01; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.fy += 0.01; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.cx += 0.01; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.cy += 0.01; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.distortion[1] += 1e-4; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.distortion.push_back(0.0); })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.camera.width_px += 1; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.floor.base_from_pixel(1, 2) += 1e-5; })));
  EXPECT_FALSE(Knows(changed([](FloorCamera& c) { c.floor.base_from_pixel(2, 0) += 1e-6; })));
  const FloorCamera singular = changed([](FloorCamera& c) { c.floor.base_from_pixel.setZero(); });
  EXPECT_FALSE(Knows(singular)) << "it moves no point, and is none";
  EXPECT_EQ(CorrectedOrGiven(info_, Other().AtResolution(0.002)).camera.fx, Other().camera.fx);
}

TEST_P(CameraCorrectionTest, AMapThatDoesNotTellKnowsNoCamera) {
  info_.given_cameras.clear();
  EXPECT_FALSE(Knows(given_));
}

TEST_P(CameraCorrectionTest, TheNewestSurveyWins) {
  info_.given_cameras.push_back(given_);
  info_.cameras.push_back(given_);
  info_.cameras[2].camera.fx += 1.0;
  const std::optional<CameraCorrection> correction = CorrectCamera(info_, given_);
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->survey, 2);
  EXPECT_EQ(correction->camera.camera.fx, given_.camera.fx + 1.0);
}

TEST_P(CameraCorrectionTest, SaysHowFarFloorPointsMove) {
  info_.cameras[0] = given_;
  EXPECT_NEAR(CorrectCamera(info_, given_)->moved_px, 0.0, 1e-3);
  info_.cameras[0].floor.base_from_pixel(0, 2) += 0.003;  // all points move by 3 and 4 mm
  info_.cameras[0].floor.base_from_pixel(1, 2) -= 0.004;
  EXPECT_NEAR(LargestDisplacement(given_, info_.cameras[0]), 0.005, 1e-6);
  EXPECT_NEAR(CorrectCamera(info_, given_)->moved_px, 0.005 / given_.floor.resolution_m, 1e-3);
  EXPECT_NEAR(CorrectCamera(info_, given_.AtResolution(0.001))->moved_px, 5.0, 1e-3);
}

}  // namespace
}  // namespace floorloc
