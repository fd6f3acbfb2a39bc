// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "mapbuilder/simulation/floor_wear.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double kResolutionM = 0.0005;
constexpr double kFloorM = 2.0;

// White dots of 7 mm on black, their centres at known map positions.
FloorTexture DottedFloor(const std::vector<Eigen::Vector2d>& dots) {
  const int side_px = static_cast<int>(kFloorM / kResolutionM);
  FloorTexture floor{cv::Mat(side_px, side_px, CV_8UC3, cv::Scalar::all(10)), kResolutionM};
  constexpr int kShift = 8;
  for (const Eigen::Vector2d& dot : dots) {
    const Eigen::Vector2d p = floor.PixelFromMap(dot) * (1 << kShift);
    cv::circle(floor.bgr, cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))),
               static_cast<int>(0.0035 / kResolutionM * (1 << kShift)), cv::Scalar::all(250), cv::FILLED, cv::LINE_AA,
               kShift);
  }
  return floor;
}

// Second moments of the brightness above the background around a pixel.
cv::Moments DotMoments(const cv::Mat& image, const Eigen::Vector2d& near_px, int reach_px) {
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  const cv::Rect box(static_cast<int>(near_px.x()) - reach_px, static_cast<int>(near_px.y()) - reach_px,
                     2 * reach_px + 1, 2 * reach_px + 1);
  cv::Mat bright;
  cv::Mat(gray(box & cv::Rect({0, 0}, gray.size())) - 12.0).convertTo(bright, CV_32FC1);
  return cv::moments(bright);
}

Eigen::Vector2d DotCentroid(const cv::Mat& image, const Eigen::Vector2d& near_px) {
  constexpr int kReachPx = 14;
  const cv::Moments m = DotMoments(image, near_px, kReachPx);
  return {static_cast<int>(near_px.x()) - kReachPx + m.m10 / m.m00,
          static_cast<int>(near_px.y()) - kReachPx + m.m01 / m.m00};
}

TEST(FloorTexture, HasItsOriginAtTheLowerLeftCorner) {
  const FloorTexture floor{cv::Mat(90, 120, CV_8UC3), 0.01};
  EXPECT_LT((floor.PixelFromMap({0.0, 0.0}) - Eigen::Vector2d(-0.5, 89.5)).norm(), 1e-9);
  EXPECT_LT((floor.PixelFromMap({1.2, 0.9}) - Eigen::Vector2d(119.5, -0.5)).norm(), 1e-9);
}

class RenderedDots : public ::testing::TestWithParam<const char*> {
 protected:
  FloorCamera Camera() const {
    const std::string name = GetParam();
    return name == "down" ? MakeDownwardCamera() : name == "forward" ? MakeForwardCamera() : MakeEquidistantCamera();
  }
};

TEST_P(RenderedDots, LieWhereTheCameraModelSays) {
  const FloorCamera camera = Camera();
  const Pose2 map_from_base(1.0, 0.9, 0.7);
  std::vector<Eigen::Vector2d> in_base;
  std::vector<Eigen::Vector2d> in_map;
  const RectM& roi = camera.floor.roi;
  for (int i = 1; i < 6; ++i) {
    for (int k = 1; k < 6; ++k) {
      in_base.emplace_back(roi.x_min + roi.width_m() * i / 6.0, roi.y_min + roi.height_m() * k / 6.0);
      in_map.push_back(map_from_base * in_base.back());
    }
  }
  const cv::Mat image = CameraRenderer(DottedFloor(in_map), camera).Render(map_from_base, {});
  for (const Eigen::Vector2d& point : in_base) {
    const Eigen::Vector2d expected = camera.RawPixelFromFloor(point);
    const double error_px = (DotCentroid(image, expected) - expected).norm();
    EXPECT_LT(error_px, 0.1) << "dot at " << point.transpose() << " in the base frame";
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, RenderedDots, ::testing::Values("down", "forward", "equidistant"));

TEST(CameraRenderer, SmearsAlongTheMotionAndKeepsTheMiddle) {
  const FloorCamera camera = MakeDownwardCamera();
  const Pose2 map_from_base(1.0, 1.0, 0.4);
  const Eigen::Vector2d point(0.2, 0.0);
  const CameraRenderer renderer(DottedFloor({map_from_base * point}), camera);
  RenderConditions moving;
  moving.motion = {0.008, 0.0, 0.0};  // 8 mm forward: 12 px up or down in the image
  const Eigen::Vector2d expected = camera.RawPixelFromFloor(point);
  const cv::Mat sharp = renderer.Render(map_from_base, {});
  const cv::Mat smeared = renderer.Render(map_from_base, moving);
  EXPECT_LT((DotCentroid(smeared, expected) - expected).norm(), 0.1);
  const cv::Moments a = DotMoments(sharp, expected, 20);
  const cv::Moments b = DotMoments(smeared, expected, 20);
  // A uniform blur of length L adds the variance L^2 / 12.
  EXPECT_NEAR(b.mu02 / b.m00 - a.mu02 / a.m00, 12.0 * 12.0 / 12.0, 1.5);
  EXPECT_NEAR(b.mu20 / b.m00 - a.mu20 / a.m00, 0.0, 0.3);
}

TEST(CameraRenderer, VibrationMovesTheImageAsTheOpticsPredict) {
  const FloorCamera camera = MakeDownwardCamera();
  const Pose2 map_from_base(1.0, 1.0, 0.0);
  const Eigen::Vector2d point(0.28, 0.1);
  const CameraRenderer renderer(DottedFloor({map_from_base * point}), camera);
  RenderConditions raised;
  raised.vibration.height_m = 0.01;
  // From 0.41 m instead of 0.40 m the point appears at 0.40 / 0.41 of its distance from the point below the camera
  // (0.2 m, 0).
  const Eigen::Vector2d below(0.2, 0.0);
  const Eigen::Vector2d expected = camera.RawPixelFromFloor(below + (point - below) * (0.40 / 0.41));
  const cv::Mat image = renderer.Render(map_from_base, raised);
  EXPECT_LT((DotCentroid(image, expected) - expected).norm(), 0.1);
  RenderConditions pitched;
  pitched.vibration.pitch_rad = 0.005;  // nose down: the optical axis meets the floor 2 mm further back
  const Eigen::Vector2d forward = camera.RawPixelFromFloor({0.2, 0.0});
  const CameraRenderer centered(DottedFloor({map_from_base * below}), camera);
  const Eigen::Vector2d measured = DotCentroid(centered.Render(map_from_base, pitched), forward);
  EXPECT_NEAR(measured.y() - forward.y(), -0.005 * camera.camera.fy, 0.15);
  EXPECT_NEAR(measured.x() - forward.x(), 0.0, 0.15);
}

std::map<std::string, std::string> FilesIn(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[fs::relative(entry.path(), folder).string()] = ReadTextFile(entry.path());
    }
  }
  return files;
}

TEST(Simulate, WritesASurveyWithDriftingOdometryFromTheIdentity) {
  const TemporaryFolder folder;
  const SimulationResult result = SyntheticFloor().WriteSurvey(folder.path() / "survey");
  const Survey survey = ReadSurvey(folder.path() / "survey");
  EXPECT_EQ(survey.frames.size(), 28U);
  ASSERT_EQ(survey.odometry.size(), survey.frames.size());
  ASSERT_EQ(survey.ground_truth.size(), survey.frames.size());
  EXPECT_LT(survey.odometry.front().ToPose2().Log().norm(), 1e-9);
  const Pose2 truth = survey.ground_truth.front().ToPose2().Between(survey.ground_truth.back().ToPose2());
  const double drift_m = truth.Between(survey.odometry.back().ToPose2()).translation().norm();
  EXPECT_GT(drift_m, 0.002);
  EXPECT_LT(drift_m, 0.3);
  EXPECT_NEAR(result.odometry_drift_m, drift_m, 1e-6);
}

TEST(Simulate, PerfectOdometryFollowsTheTruth) {
  const TemporaryFolder folder;
  SimulateOptions options = SyntheticFloor().SurveyOptions(folder.path() / "survey");
  options.path.odometry = options.path.odometry.Scaled(0.0);
  EXPECT_LT(Simulate(options).odometry_drift_m, 1e-6);
}

TEST(Simulate, GivesTheSameBytesForTheSameSeedAndAnyNumberOfThreads) {
  const TemporaryFolder folder;
  SimulateOptions options = SyntheticFloor().SurveyOptions(folder.path() / "a");
  options.path.type = PathType::kRandom;
  options.path.frames = 4;
  options.wear = 0.05;
  options.run.threads = 1;
  Simulate(options);
  options.out = folder.path() / "b";
  options.run.threads = 3;
  Simulate(options);
  options.out = folder.path() / "c";
  options.seed += 1;
  Simulate(options);
  const auto a = FilesIn(folder.path() / "a");
  EXPECT_EQ(a.size(), 8U);
  EXPECT_TRUE(a == FilesIn(folder.path() / "b"));
  EXPECT_NE(a.at("images/000000.jpg"), FilesIn(folder.path() / "c").at("images/000000.jpg"));
}

TEST(Simulate, WritesAWrongCalibrationBesideTheTrueOneAndTheSameImages) {
  const TemporaryFolder folder;
  SimulateOptions options = SyntheticFloor().SurveyOptions(folder.path() / "exact");
  options.path.type = PathType::kRandom;
  options.path.frames = 2;
  Simulate(options);
  options.out = folder.path() / "wrong";
  options.calibration_error = CalibrationError::Typical(1.0, 0.002);
  Simulate(options);
  auto exact = FilesIn(folder.path() / "exact");
  auto wrong = FilesIn(options.out);
  EXPECT_FALSE(exact.contains("camera_truth.yaml"));
  EXPECT_FALSE(exact.contains("floor_truth.yaml"));
  EXPECT_NE(wrong.at("camera.yaml"), exact.at("camera.yaml"));
  EXPECT_NE(wrong.at("floor.yaml"), exact.at("floor.yaml"));
  EXPECT_EQ(wrong.at("camera_truth.yaml"), exact.at("camera.yaml"));
  const FloorPlane truth = ParseFloorYaml(wrong.at("floor_truth.yaml"), "floor_truth.yaml");
  EXPECT_TRUE(truth.base_from_pixel == options.camera.floor.base_from_pixel);
  for (const char* calibration : {"camera.yaml", "floor.yaml", "camera_truth.yaml", "floor_truth.yaml"}) {
    exact.erase(calibration);
    wrong.erase(calibration);
  }
  EXPECT_TRUE(wrong == exact) << "a calibration does not change what the camera sees";
  const Eigen::Vector2d corner(0.0, 0.0);
  const FloorCamera expected = Miscalibrated(options.camera, options.calibration_error);
  const FloorCamera read = ReadSurvey(options.out).camera;
  EXPECT_LT((read.FloorFromRawPixel(corner) - expected.FloorFromRawPixel(corner)).norm(), 1e-6);
}

TEST(Simulate, RefusesAFolderThatIsNotEmpty) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "precious.txt") << "keep me";
  try {
    SyntheticFloor().WriteDrive(folder.path(), 1);
    FAIL() << "wrote into a folder that isn't empty";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.path().string()));
    EXPECT_THAT(error.what(), HasSubstr("not an empty folder"));
  }
  EXPECT_EQ(FilesIn(folder.path()).size(), 1U);
}

TEST(Simulate, LeavesNothingBehindWhenItFails) {
  const TemporaryFolder folder;
  SimulateOptions options = SyntheticFloor().SurveyOptions(folder.path() / "survey");
  options.floor.source = "no-such-picture.png";
  EXPECT_THROW(Simulate(options), InputError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(FloorWear, ChangesAboutTheAskedShare) {
  FloorTextureOptions options;
  options.width_m = 1.2;
  options.height_m = 0.9;
  const FloorTexture fresh = MakeFloorTexture(options);
  for (const double share : {0.05, 0.2}) {
    FloorTexture worn = fresh;
    worn.bgr = fresh.bgr.clone();
    WearFloor(worn, share, 7);
    cv::Mat difference;
    cv::absdiff(fresh.bgr, worn.bgr, difference);
    cv::cvtColor(difference, difference, cv::COLOR_BGR2GRAY);
    const double changed = cv::countNonZero(difference > 6) / static_cast<double>(difference.total());
    EXPECT_NEAR(changed, share, 0.25 * share);
  }
}

TEST(PlanPath, KeepsTheViewOnTheFloor) {
  PathOptions options;
  options.roi = MakeDownwardCamera().floor.roi;
  for (const PathType type : {PathType::kSurvey, PathType::kDrive, PathType::kRandom}) {
    options.type = type;
    for (const PathFrame& frame : PlanPath(options).frames) {
      for (const double x : {options.roi.x_min, options.roi.x_max}) {
        for (const double y : {options.roi.y_min, options.roi.y_max}) {
          const Eigen::Vector2d corner = frame.map_from_base * Eigen::Vector2d(x, y);
          ASSERT_TRUE((RectM{0.0, options.floor_width_m, 0.0, options.floor_height_m}).Contains(corner));
        }
      }
    }
  }
}

TEST(PlanPath, DrivesAtConstantSpeedWithoutSlippingSideways) {
  PathOptions options;
  options.roi = MakeDownwardCamera().floor.roi;
  options.type = PathType::kDrive;
  options.frames = 60;
  for (const PathFrame& frame : PlanPath(options).frames) {
    EXPECT_NEAR(frame.twist.y(), 0.0, 0.02);
    EXPECT_LT(frame.twist.head<2>().norm(), 1.1 * options.speed_m_per_s);
  }
}

TEST(PlanPath, RefusesAFloorSmallerThanTheView) {
  PathOptions options;
  options.roi = MakeDownwardCamera().floor.roi;
  options.floor_height_m = 0.3;
  for (const PathType type : {PathType::kSurvey, PathType::kDrive, PathType::kRandom}) {
    options.type = type;
    EXPECT_THROW(PlanPath(options), std::invalid_argument);
  }
}

}  // namespace
}  // namespace floorloc
