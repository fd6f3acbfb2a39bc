// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/rectifier.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::InThreads;
using testing_vision::Same;

// A camera 0.4 m above the floor and 0.2 m ahead of the base, tilted forward from straight down.
Eigen::Matrix3d BaseFromPixel(const CameraModel& camera, double tilt_rad) {
  const Eigen::Vector3d center(0.2, 0.0, 0.4);
  Eigen::Matrix3d base_from_camera;
  base_from_camera.col(0) = Eigen::Vector3d(0.0, -1.0, 0.0);
  base_from_camera.col(2) = Eigen::Vector3d(std::sin(tilt_rad), 0.0, -std::cos(tilt_rad));
  base_from_camera.col(1) = base_from_camera.col(2).cross(base_from_camera.col(0));
  Eigen::Matrix3d camera_from_floor = base_from_camera.transpose();
  camera_from_floor.col(2) = -base_from_camera.transpose() * center;
  Eigen::Matrix3d intrinsics;
  intrinsics << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return (intrinsics * camera_from_floor).inverse();
}

FloorCamera MakeCamera(DistortionModel model) {
  FloorCamera camera;
  camera.camera = {"test", 640, 480, 601.0, 598.0, 322.5, 236.0, model, {}};
  switch (model) {
    case DistortionModel::kPlumbBob:
      camera.camera.distortion = {-0.24, 0.07, 0.001, -0.0008, -0.01};
      break;
    case DistortionModel::kRationalPolynomial:
      camera.camera.distortion = {0.3, 0.05, 0.0006, -0.0004, 0.002, 0.55, 0.08, 0.004};
      break;
    case DistortionModel::kEquidistant:
      camera.camera.distortion = {0.02, -0.006, 0.003, -0.001};
      break;
  }
  camera.floor.base_from_pixel = BaseFromPixel(camera.camera, 0.15);
  camera.floor.roi = {0.14, 0.38, -0.16, 0.17};
  camera.floor.resolution_m = 0.0007;
  return camera;
}

// A camera's image of Gaussian dots at known floor points.
cv::Mat RenderDots(const FloorCamera& camera, const std::vector<Eigen::Vector2d>& points) {
  constexpr double kSigmaPx = 3.0;
  constexpr int kReachPx = 12;
  cv::Mat raw(camera.camera.height_px, camera.camera.width_px, CV_8UC1, cv::Scalar(20));
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d center = camera.RawPixelFromFloor(point);
    const int middle_u = static_cast<int>(std::lround(center.x()));
    const int middle_v = static_cast<int>(std::lround(center.y()));
    for (int v = middle_v - kReachPx; v <= middle_v + kReachPx; ++v) {
      for (int u = middle_u - kReachPx; u <= middle_u + kReachPx; ++u) {
        const double r2 = (Eigen::Vector2d(u, v) - center).squaredNorm();
        raw.at<std::uint8_t>(v, u) =
            cv::saturate_cast<std::uint8_t>(20.0 + 220.0 * std::exp(-0.5 * r2 / (kSigmaPx * kSigmaPx)));
      }
    }
  }
  return raw;
}

Eigen::Vector2d CentroidNear(const cv::Mat& gray, const Eigen::Vector2d& near_px) {
  constexpr int kReachPx = 14;
  const int u0 = static_cast<int>(std::lround(near_px.x())) - kReachPx;
  const int v0 = static_cast<int>(std::lround(near_px.y())) - kReachPx;
  cv::Mat dot;
  gray(cv::Rect(u0, v0, 2 * kReachPx + 1, 2 * kReachPx + 1)).convertTo(dot, CV_32F, 1.0, -20.0);
  const cv::Moments m = cv::moments(dot);
  return {u0 + m.m10 / m.m00, v0 + m.m01 / m.m00};
}

std::vector<Eigen::Vector2d> DotPoints() {
  std::vector<Eigen::Vector2d> points;
  for (double x = 0.17; x < 0.36; x += 0.04) {
    for (double y = -0.13; y < 0.15; y += 0.04) {
      points.emplace_back(x, y);
    }
  }
  return points;
}

class RectifierOfModel : public ::testing::TestWithParam<DistortionModel> {};

TEST_P(RectifierOfModel, FloorPointsLandAtTheirGridPixels) {
  const FloorCamera camera = MakeCamera(GetParam());
  const Rectifier rectifier(camera);
  const std::vector<Eigen::Vector2d> points = DotPoints();
  const GroundImage image = rectifier.Rectify(RenderDots(camera, points));
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d expected = image.grid.PixelFromBase(point);
    EXPECT_LT((CentroidNear(image.gray, expected) - expected).norm(), 0.1) << point.transpose();
  }
}

TEST_P(RectifierOfModel, EveryThreadGetsTheSameImage) {
  const Rectifier rectifier(MakeCamera(GetParam()));
  const cv::Mat raw = testing_vision::MakeTexture({640, 480}, 120.0, 25.0, 3);
  const GroundImage expected = rectifier.Rectify(raw);
  std::vector<GroundImage> images(8);
  InThreads(8, [&](std::size_t i) { images[i] = rectifier.Rectify(raw); });
  for (const GroundImage& image : images) {
    EXPECT_TRUE(Same(image.gray, expected.gray));
  }
}

INSTANTIATE_TEST_SUITE_P(AllModels, RectifierOfModel,
                         ::testing::Values(DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial,
                                           DistortionModel::kEquidistant),
                         [](const auto& name) { return std::string(ToString(name.param)); });

TEST(RectifierTest, GridCoversTheRegionOfInterest) {
  const FloorCamera camera = MakeCamera(DistortionModel::kPlumbBob);
  const GroundGrid grid = GroundGrid::FromFloor(camera.floor);
  EXPECT_EQ(grid.width_px, 471);                                  // 0.33 m across
  EXPECT_EQ(grid.height_px, 343);                                 // 0.24 m ahead
  const Eigen::Vector2d corner = grid.BaseFromPixel(-0.5, -0.5);  // outer corner of the top left pixel
  EXPECT_NEAR(corner.x(), 0.38, 1e-12);
  EXPECT_NEAR(corner.y(), 0.17, 1e-12);
}

TEST(RectifierTest, MaskIsWhereTheCameraLooks) {
  FloorCamera camera = MakeCamera(DistortionModel::kPlumbBob);
  camera.floor.roi = {0.1, 0.5, -0.4, 0.1};  // extends beyond the right border of the image
  const Rectifier rectifier(camera);
  const GroundImage image = rectifier.Rectify(cv::Mat(480, 640, CV_8UC1, cv::Scalar(200)));
  int seen = 0;
  for (int v = 0; v < image.grid.height_px; ++v) {
    for (int u = 0; u < image.grid.width_px; ++u) {
      const Eigen::Vector2d raw = camera.RawPixelFromFloor(image.grid.BaseFromPixel(u, v));
      const bool inside = raw.allFinite() && camera.camera.Contains(raw);
      ASSERT_EQ(image.mask.at<std::uint8_t>(v, u), inside ? 255 : 0) << u << " " << v;
      if (!inside) {
        ASSERT_EQ(image.gray.at<std::uint8_t>(v, u), 0) << u << " " << v;
      }
      seen += inside ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 1000);
  EXPECT_LT(seen, image.grid.width_px * image.grid.height_px - 1000);
}

TEST(RectifierTest, ColourAndGreyAgree) {
  const Rectifier rectifier(MakeCamera(DistortionModel::kPlumbBob));
  const cv::Mat gray = testing_vision::MakeTexture({640, 480}, 120.0, 25.0, 4);
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  cv::Mat expected;
  cv::cvtColor(rectifier.Rectify(gray).gray, expected, cv::COLOR_GRAY2BGR);
  EXPECT_TRUE(Same(rectifier.RectifyImage(color), expected));
}

TEST(RectifierTest, RefusesImagesOfAnotherCamera) {
  const Rectifier rectifier(MakeCamera(DistortionModel::kPlumbBob));
  EXPECT_THROW(rectifier.Rectify(cv::Mat(480, 641, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(rectifier.Rectify(cv::Mat(479, 640, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(rectifier.Rectify(cv::Mat(480, 640, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(rectifier.Rectify(cv::Mat(480, 640, CV_16UC1)), std::invalid_argument);
  EXPECT_THROW(rectifier.Rectify(cv::Mat()), std::invalid_argument);
}

TEST(RectifierTest, RefusesACameraThatDoesNotSeeItsFloor) {
  FloorCamera camera = MakeCamera(DistortionModel::kPlumbBob);
  camera.floor.roi = {5.0, 5.2, -0.1, 0.1};
  EXPECT_THROW(Rectifier{camera}, std::invalid_argument);
}

TEST(RectifierMaskTest, WhatIsMaskedIsUnseen) {
  const FloorCamera camera = MakeCamera(DistortionModel::kPlumbBob);
  const cv::Size size(camera.camera.width_px, camera.camera.height_px);
  const cv::Mat raw(size, CV_8UC1, cv::Scalar(200));
  cv::Mat mask(size, CV_8UC1, cv::Scalar(1));
  mask.colRange(0, size.width / 2).setTo(0);
  const Rectifier plain(camera);
  const Rectifier masked(camera, mask);
  EXPECT_EQ(plain.masked_share(), 0.0);
  EXPECT_NEAR(masked.masked_share(), 0.5, 0.1);
  EXPECT_EQ(cv::countNonZero(masked.mask() & ~plain.mask()), 0);
  const GroundImage image = masked.Rectify(raw);
  EXPECT_EQ(cv::countNonZero(image.gray & ~masked.mask()), 0);
  EXPECT_EQ(cv::countNonZero(image.gray), cv::countNonZero(masked.mask()));
  cv::Mat kept;
  plain.Rectify(raw).gray.copyTo(kept, masked.mask());
  EXPECT_EQ(cv::norm(kept, image.gray, cv::NORM_INF), 0.0);
}

TEST(RectifierMaskTest, AMaskOfAnotherCameraIsRefused) {
  const FloorCamera camera = MakeCamera(DistortionModel::kPlumbBob);
  EXPECT_THROW(Rectifier(camera, cv::Mat(10, 10, CV_8UC1, cv::Scalar(255))), std::invalid_argument);
  const cv::Size size(camera.camera.width_px, camera.camera.height_px);
  EXPECT_THROW(Rectifier(camera, cv::Mat(size, CV_8UC3, cv::Scalar::all(255))), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
