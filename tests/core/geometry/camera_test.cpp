// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace floorloc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CameraModel MakeCamera(DistortionModel model, std::vector<double> distortion) {
  CameraModel camera;
  camera.width_px = 640;
  camera.height_px = 480;
  camera.fx = 598.3;
  camera.fy = 597.6;
  camera.cx = 322.4;
  camera.cy = 238.7;
  camera.distortion_model = model;
  camera.distortion = std::move(distortion);
  return camera;
}

CameraModel PlumbBob() { return MakeCamera(DistortionModel::kPlumbBob, {-0.25, 0.06, 0.0008, -0.0005, 0.01}); }
CameraModel Rational() {
  return MakeCamera(DistortionModel::kRationalPolynomial, {0.3, 0.02, -0.0003, 0.0002, 0.001, 0.62, 0.09, 0.004});
}
CameraModel Fisheye() {
  CameraModel camera = MakeCamera(DistortionModel::kEquidistant, {0.02, -0.004, 0.001, -0.0002});
  camera.fx = camera.fy = 250.0;
  return camera;
}

class LensTest : public ::testing::TestWithParam<CameraModel> {};

TEST_P(LensTest, DistortUndoesUndistortAllOverTheImage) {
  const CameraModel& camera = GetParam();
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(0, camera.width_px - 1);
  std::uniform_real_distribution<double> v(0, camera.height_px - 1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d raw(u(rng), v(rng));
    const Eigen::Vector2d undistorted = camera.Undistort(raw);
    ASSERT_TRUE(undistorted.allFinite()) << raw.transpose();
    EXPECT_LT((camera.Distort(undistorted) - raw).norm(), 1e-8) << raw.transpose();
  }
}

TEST_P(LensTest, UndistortUndoesDistort) {
  const CameraModel& camera = GetParam();
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<double> u(0, camera.width_px - 1);
  std::uniform_real_distribution<double> v(0, camera.height_px - 1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d undistorted(u(rng), v(rng));
    EXPECT_LT((camera.Undistort(camera.Distort(undistorted)) - undistorted).norm(), 1e-7) << undistorted.transpose();
  }
}

TEST_P(LensTest, PrincipalPointStays) {
  const CameraModel& camera = GetParam();
  const Eigen::Vector2d center(camera.cx, camera.cy);
  EXPECT_LT((camera.Distort(center) - center).norm(), 1e-12);
  EXPECT_LT((camera.Undistort(center) - center).norm(), 1e-9);
}

// Undistort gives NaN or a point on the same side as the raw pixel, inside the radius at which the distortion folds.
void ExpectInverseOrNotANumberFarOutside(const CameraModel& camera) {
  const Eigen::Vector2d center(camera.cx, camera.cy);
  for (double radius = 100; radius < 20000; radius *= 1.1) {
    for (double angle = 0; angle < 6.28; angle += 0.37) {
      const Eigen::Vector2d raw = center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const Eigen::Vector2d undistorted = camera.Undistort(raw);
      if (!undistorted.allFinite()) {
        continue;
      }
      EXPECT_LT((camera.Distort(undistorted) - raw).norm(), 1e-6) << raw.transpose();
      EXPECT_GT((undistorted - center).dot(raw - center), 0.0) << raw.transpose();
      double previous = 0.0;
      for (double t = 0.05; t <= 1.0; t += 0.05) {
        const double distance = (camera.Distort(center + t * (undistorted - center)) - center).norm();
        EXPECT_GT(distance, previous) << raw.transpose() << " folds at " << t;
        previous = distance;
      }
    }
  }
}

TEST_P(LensTest, UndistortIsTheInverseOrNotANumberFarOutsideTheImage) {
  ExpectInverseOrNotANumberFarOutside(GetParam());
}

TEST(CameraModel, UndistortNeverAnswersFromBehindAFold) {
  ExpectInverseOrNotANumberFarOutside(MakeCamera(DistortionModel::kPlumbBob, {-0.3, 0, 0, 0}));
  ExpectInverseOrNotANumberFarOutside(MakeCamera(DistortionModel::kPlumbBob, {-0.5, 0.08, 0, 0, 0.002}));
  ExpectInverseOrNotANumberFarOutside(MakeCamera(DistortionModel::kEquidistant, {-0.3, 0, 0, 0}));
  ExpectInverseOrNotANumberFarOutside(
      MakeCamera(DistortionModel::kRationalPolynomial, {0.1, 0, 0, 0, 0, 0.3, -0.1, 0}));
}

INSTANTIATE_TEST_SUITE_P(Models, LensTest, ::testing::Values(PlumbBob(), Rational(), Fisheye()),
                         [](const auto& test) { return ToString(test.param.distortion_model); });

TEST(CameraModel, PlumbBobByHand) {
  CameraModel camera = MakeCamera(DistortionModel::kPlumbBob, {0.1, 0.01, 0.002, 0.003});
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 0;
  // x = 1, y = 2, r2 = 5: radial = 1 + 0.5 + 0.25, tangential = (2 p1 x y + p2 (r2 + 2 x^2), p1 (r2 + 2 y^2) + 2 p2 x
  // y).
  const Eigen::Vector2d raw = camera.Distort({100, 200});
  EXPECT_NEAR(raw.x(), 100 * (1.75 + 2 * 0.002 * 2 + 0.003 * 7), 1e-9);
  EXPECT_NEAR(raw.y(), 100 * (3.5 + 0.002 * 13 + 2 * 0.003 * 2), 1e-9);
}

TEST(CameraModel, RationalByHand) {
  CameraModel camera = MakeCamera(DistortionModel::kRationalPolynomial, {0.1, 0.02, 0, 0, 0.03, 0.4, 0.05, 0.06});
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 0;
  const Eigen::Vector2d raw = camera.Distort({100, 100});
  const double radial = (1 + 0.1 * 2 + 0.02 * 4 + 0.03 * 8) / (1 + 0.4 * 2 + 0.05 * 4 + 0.06 * 8);
  EXPECT_NEAR(raw.x(), 100 * radial, 1e-9);
  EXPECT_NEAR(raw.y(), 100 * radial, 1e-9);
}

TEST(CameraModel, IdealFisheyeIsProportionalToTheAngle) {
  CameraModel camera = MakeCamera(DistortionModel::kEquidistant, {0, 0, 0, 0});
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 0;
  const double angle = 1.2;
  EXPECT_NEAR(camera.Distort({100 * std::tan(angle), 0}).x(), 100 * angle, 1e-9);
  EXPECT_NEAR(camera.Undistort({100 * angle, 0}).x(), 100 * std::tan(angle), 1e-6);
}

TEST(CameraModel, ContainsThePixelCentresOfTheImage) {
  const CameraModel camera = PlumbBob();
  EXPECT_TRUE(camera.Contains({0, 0}));
  EXPECT_TRUE(camera.Contains({639, 479}));
  EXPECT_FALSE(camera.Contains({-0.01, 0}));
  EXPECT_FALSE(camera.Contains({0, -0.01}));
  EXPECT_FALSE(camera.Contains({639.01, 0}));
  EXPECT_FALSE(camera.Contains({0, 479.01}));
  EXPECT_FALSE(camera.Contains({kNan, 0}));
}

struct BrokenCamera {
  const char* name;
  std::function<void(CameraModel&)> break_it;
  const char* message;
};
std::ostream& operator<<(std::ostream& out, const BrokenCamera& broken) { return out << broken.name; }

class CameraCheckTest : public ::testing::TestWithParam<BrokenCamera> {};

TEST_P(CameraCheckTest, NamesTheField) {
  CameraModel camera = PlumbBob();
  ASSERT_NO_THROW(camera.Check());
  GetParam().break_it(camera);
  try {
    camera.Check();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().message));
  }
}

const BrokenCamera kBrokenCameras[] = {
    {"NoWidth", [](CameraModel& c) { c.width_px = 0; }, "image_width"},
    {"NegativeWidth", [](CameraModel& c) { c.width_px = -640; }, "image_width"},
    {"HugeWidth", [](CameraModel& c) { c.width_px = 16385; }, "image_width"},
    {"NoHeight", [](CameraModel& c) { c.height_px = 0; }, "image_height"},
    {"HugeHeight", [](CameraModel& c) { c.height_px = 1 << 20; }, "image_height"},
    {"NoFx", [](CameraModel& c) { c.fx = 0; }, "focal lengths"},
    {"NegativeFy", [](CameraModel& c) { c.fy = -1; }, "focal lengths"},
    {"NanFx", [](CameraModel& c) { c.fx = kNan; }, "focal lengths"},
    {"InfiniteFy", [](CameraModel& c) { c.fy = std::numeric_limits<double>::infinity(); }, "focal lengths"},
    {"NanCx", [](CameraModel& c) { c.cx = kNan; }, "principal point"},
    {"NanCy", [](CameraModel& c) { c.cy = kNan; }, "principal point"},
    {"TooFewNumbers", [](CameraModel& c) { c.distortion.resize(3); }, "distortion_coefficients"},
    {"TooManyNumbers", [](CameraModel& c) { c.distortion.resize(6); }, "distortion_coefficients"},
    {"FisheyeWithFive", [](CameraModel& c) { c.distortion_model = DistortionModel::kEquidistant; },
     "distortion_coefficients"},
    {"RationalWithFive", [](CameraModel& c) { c.distortion_model = DistortionModel::kRationalPolynomial; },
     "distortion_coefficients"},
    {"NanDistortion", [](CameraModel& c) { c.distortion[2] = kNan; }, "distortion_coefficients"},
};
INSTANTIATE_TEST_SUITE_P(Fields, CameraCheckTest, ::testing::ValuesIn(kBrokenCameras),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace floorloc
