// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_sigma.h"

#include <gtest/gtest.h>

#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

const Board kBoard{9, 6, 0.02, {}};
constexpr double kRadiusPx = 300.0;

CameraCalibration Calibrate(const CameraModel& camera, int views, double noise_px) {
  CameraCalibrationInput input{kBoard, camera.width_px, camera.height_px, {}};
  const std::vector<BoardPlacement> placements = VariedPlacements(camera, kBoard, views);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const Eigen::Isometry3d pose = PlaceBoard(camera, kBoard, placements[i]);
    input.views.push_back(
        {"image " + std::to_string(i), ProjectBoard(camera, kBoard, pose, noise_px, static_cast<unsigned>(i))});
  }
  return CalibrateCamera(input, {});
}

TEST(CalibrationSigma, GrowsWithTheNoiseAndFallsWithTheImages) {
  const CameraModel camera = MakeBoardCamera();
  const double few_px = CalibrationSigmaPx(Calibrate(camera, 6, 0.1), kRadiusPx);
  const double many_px = CalibrationSigmaPx(Calibrate(camera, 24, 0.1), kRadiusPx);
  const double noisy_px = CalibrationSigmaPx(Calibrate(camera, 24, 0.3), kRadiusPx);
  EXPECT_LT(many_px, few_px);
  EXPECT_GT(many_px, 0.1) << "never better than the corners fit";
  EXPECT_NEAR(noisy_px / many_px, 3.0, 0.5);
}

// What the lens model can't describe stays in the reprojection error.
TEST(CalibrationSigma, AResidualOfTheLensCounts) {
  CameraCalibration calibration = Calibrate(MakeBoardCamera(), 12, 0.05);
  const double before_px = CalibrationSigmaPx(calibration, kRadiusPx);
  EXPECT_LT(before_px, 0.3);
  calibration.rms_px = 1.0;
  EXPECT_GT(CalibrationSigmaPx(calibration, kRadiusPx), 1.0 / std::sqrt(2.0));
  calibration.covariance.reset();
  EXPECT_NEAR(CalibrationSigmaPx(calibration, kRadiusPx), 1.0 / std::sqrt(2.0), 1e-12);
}

// Another pose of the camera explains a shift of the principal point all but for its distortion; the floor is measured
// with the lens as it is.
TEST(CalibrationSigma, WhatThePoseExplainsDoesNotCount) {
  CameraCalibration calibration = Calibrate(MakeBoardCamera(), 12, 0.05);
  calibration.rms_px = 0.0;
  calibration.camera.distortion.assign(calibration.camera.distortion.size(), 0.0);
  const auto sigma_of = [&](int parameter, double sigma) {
    calibration.covariance = LensCovariance::Zero();
    (*calibration.covariance)(parameter, parameter) = sigma * sigma;
    return CalibrationSigmaPx(calibration, kRadiusPx);
  };
  const double one_px = 1.0 / calibration.camera.width_px;
  EXPECT_LT(sigma_of(2, one_px), 1e-3);
  EXPECT_LT(sigma_of(3, one_px), 1e-3);
  EXPECT_GT(sigma_of(0, one_px), 0.1) << "fx alone: pixels that are not square";
  EXPECT_GT(sigma_of(kFirstCoefficient, 0.01), 0.2);
}

}  // namespace
}  // namespace floorloc
