// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/camera_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/input_error.h"
#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

const Board kBoard{9, 6, 0.02, {}};
constexpr double kNoisePx = 0.05;

CameraCalibrationInput MakeInput(const CameraModel& camera, const std::vector<BoardPlacement>& placements) {
  CameraCalibrationInput input{kBoard, camera.width_px, camera.height_px, {}};
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const Eigen::Isometry3d pose = PlaceBoard(camera, kBoard, placements[i]);
    input.views.push_back(
        {"image " + std::to_string(i), ProjectBoard(camera, kBoard, pose, kNoisePx, static_cast<unsigned>(i))});
  }
  return input;
}

CameraCalibration Calibrate(const CameraModel& camera, std::optional<DistortionModel> model) {
  CameraCalibrationOptions options;
  options.model = model;
  return CalibrateCamera(MakeInput(camera, VariedPlacements(camera, kBoard, 18)), options);
}

// Largest difference of the two cameras' undistorted points, within the radius covered by boards.
double WorstDisagreementPx(const CameraModel& truth, const CameraModel& found) {
  double worst = 0.0;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const Eigen::Vector2d raw((0.05 + 0.9 * i / 20) * truth.width_px, (0.05 + 0.9 * j / 20) * truth.height_px);
      if ((raw - Eigen::Vector2d(truth.cx, truth.cy)).norm() > 225.0) {
        continue;
      }
      const Eigen::Vector2d px = truth.Undistort(raw);
      const Eigen::Vector2d same((px.x() - truth.cx) / truth.fx * found.fx + found.cx,
                                 (px.y() - truth.cy) / truth.fy * found.fy + found.cy);
      worst = std::max(worst, (found.Distort(same) - raw).norm());
    }
  }
  return worst;
}

CameraModel Fisheye() {
  CameraModel camera = MakeBoardCamera();
  camera.fx = camera.fy = 280.0;
  camera.distortion_model = DistortionModel::kEquidistant;
  camera.distortion = {-0.02, 0.008, -0.004, 0.0006};
  return camera;
}

CameraModel Rational() {
  CameraModel camera = MakeBoardCamera();
  camera.fx = camera.fy = 300.0;
  camera.distortion_model = DistortionModel::kRationalPolynomial;
  camera.distortion = {0.3, 0.02, 0.0005, -0.0004, 0.0, 0.62, 0.15, 0.0};
  return camera;
}

TEST(CalibrateCamera, RecoversAPlumbBobLens) {
  const CameraModel truth = MakeBoardCamera();
  const CameraCalibration found = Calibrate(truth, DistortionModel::kPlumbBob);
  EXPECT_NEAR(found.camera.fx, truth.fx, 0.8);
  EXPECT_NEAR(found.camera.fy, truth.fy, 0.8);
  EXPECT_NEAR(found.camera.cx, truth.cx, 0.5);
  EXPECT_NEAR(found.camera.cy, truth.cy, 0.5);
  EXPECT_NEAR(found.camera.distortion[0], truth.distortion[0], 0.01);
  EXPECT_EQ(found.camera.distortion.size(), 5u);
  EXPECT_LT(WorstDisagreementPx(truth, found.camera), 1.0);
  EXPECT_NEAR(found.rms_px, kNoisePx * std::sqrt(2.0), 0.01);
}

TEST(CalibrateCamera, RecoversARationalLens) {
  const CameraModel truth = Rational();
  const CameraCalibration found = Calibrate(truth, DistortionModel::kRationalPolynomial);
  EXPECT_EQ(found.camera.distortion.size(), 8u);
  EXPECT_LT(WorstDisagreementPx(truth, found.camera), 0.8);
}

TEST(CalibrateCamera, RecoversAFisheyeLens) {
  const CameraModel truth = Fisheye();
  const CameraCalibration found = Calibrate(truth, DistortionModel::kEquidistant);
  EXPECT_NEAR(found.camera.fx, truth.fx, 0.4);
  EXPECT_LT(WorstDisagreementPx(truth, found.camera), 0.5);
}

TEST(CalibrateCamera, ChoosesTheModelWithTheFewestCoefficientsThatExplainsTheLens) {
  EXPECT_EQ(Calibrate(MakeBoardCamera(), std::nullopt).camera.distortion_model, DistortionModel::kPlumbBob);
  EXPECT_EQ(Calibrate(Fisheye(), std::nullopt).camera.distortion_model, DistortionModel::kEquidistant);
}

TEST(CalibrateCamera, LeavesK3AtZeroUnlessTheLensHasOne) {
  EXPECT_EQ(Calibrate(MakeBoardCamera(), DistortionModel::kPlumbBob).camera.distortion[4], 0.0);
  CameraModel strong = MakeBoardCamera();
  strong.fx = strong.fy = 300.0;
  strong.distortion = {-0.28, 0.11, 0.0, 0.0, -0.025};
  EXPECT_NEAR(Calibrate(strong, DistortionModel::kPlumbBob).camera.distortion[4], -0.025, 0.01);
}

// Over many noise samples the errors must agree with the standard deviations.
TEST(CalibrateCamera, StandardDeviationsAreHonest) {
  const CameraModel truth = MakeBoardCamera();
  CameraCalibrationInput input = MakeInput(truth, VariedPlacements(truth, kBoard, 10));
  constexpr int kTrials = 24;
  double squares = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    for (std::size_t i = 0; i < input.views.size(); ++i) {
      const Eigen::Isometry3d pose = PlaceBoard(truth, kBoard, VariedPlacements(truth, kBoard, 10)[i]);
      input.views[i].view =
          ProjectBoard(truth, kBoard, pose, kNoisePx, static_cast<unsigned>(1000 + 100 * trial + static_cast<int>(i)));
    }
    const CameraCalibration found = CalibrateCamera(input, {});
    ASSERT_TRUE(found.covariance.has_value());
    squares += std::pow((found.camera.fx - truth.fx) / found.SigmaPx(0), 2) +
               std::pow((found.camera.cx - truth.cx) / found.SigmaPx(2), 2);
  }
  EXPECT_THAT(squares / (2 * kTrials), ::testing::AllOf(::testing::Gt(0.5), ::testing::Lt(1.8)));
}

TEST(CalibrateCamera, LeavesOutAnImageThatDisagrees) {
  const CameraModel truth = MakeBoardCamera();
  CameraCalibrationInput input = MakeInput(truth, VariedPlacements(truth, kBoard, 12));
  for (std::size_t i = 0; i < input.views[7].view.raw_px.size(); ++i) {
    const double u = input.views[7].view.raw_px[i].x() / truth.width_px;
    input.views[7].view.raw_px[i].y() += 3.0 * std::sin(20.0 * u);  // a warped board
  }
  const CameraCalibration found = CalibrateCamera(input, {});
  for (std::size_t i = 0; i < found.views.size(); ++i) {
    EXPECT_EQ(found.views[i].used, i != 7) << found.views[i].name;
  }
  EXPECT_EQ(found.used_count(), 11);
  EXPECT_LT(WorstDisagreementPx(truth, found.camera), 0.8);
}

TEST(CalibrateCamera, RequiresThreeImages) {
  const CameraModel truth = MakeBoardCamera();
  try {
    CalibrateCamera(MakeInput(truth, VariedPlacements(truth, kBoard, 2)), {});
    FAIL() << "two images were enough";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("found in 2 images"));
  }
}

}  // namespace
}  // namespace floorloc
