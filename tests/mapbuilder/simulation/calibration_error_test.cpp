// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/calibration_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/geometry/mounting.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

std::vector<FloorCamera> Cameras() { return {MakeDownwardCamera(), MakeForwardCamera(), MakeEquidistantCamera()}; }

FloorCamera WithoutDistortion(FloorCamera camera) {
  camera.camera.distortion.assign(camera.camera.distortion.size(), 0.0);
  return camera;
}

std::vector<Eigen::Vector2d> RawCorners(const CameraModel& camera) {
  const double right = camera.width_px - 1.0, bottom = camera.height_px - 1.0;
  return {{0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}};
}

std::vector<Eigen::Vector2d> PointsOfRoi(const RectM& roi) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= 4; ++i) {
    for (int k = 0; k <= 4; ++k) {
      points.emplace_back(roi.x_min + 0.25 * i * roi.width_m(), roi.y_min + 0.25 * k * roi.height_m());
    }
  }
  return points;
}

// Of the raw pixel of a ray, by the wrong lens.
Eigen::Vector2d LensError(const CameraModel& truth, const CameraModel& wrong, const Eigen::Vector2d& raw_px) {
  return wrong.Distort(truth.Undistort(raw_px)) - raw_px;
}

// Of the point where the wrong calibration has what a raw pixel sees.
Eigen::Vector2d FloorError(const FloorCamera& truth, const FloorCamera& wrong, const Eigen::Vector2d& raw_px) {
  return wrong.FloorFromRawPixel(raw_px) - truth.FloorFromRawPixel(raw_px);
}

TEST(CalibrationError, NoErrorReproducesTheCameraExactly) {
  for (const FloorCamera& camera : Cameras()) {
    const FloorCamera same = Miscalibrated(camera, {});
    EXPECT_EQ(same.camera.distortion, camera.camera.distortion);
    EXPECT_EQ(same.camera.fx, camera.camera.fx);
    EXPECT_EQ(same.camera.cx, camera.camera.cx);
    EXPECT_TRUE(same.floor.base_from_pixel.isApprox(camera.floor.base_from_pixel, 1e-12));
    for (const Eigen::Vector2d& point : PointsOfRoi(camera.floor.roi)) {
      const Eigen::Vector2d raw_px = camera.RawPixelFromFloor(point);
      EXPECT_LT((same.RawPixelFromFloor(point) - raw_px).norm(), 1e-9);
    }
  }
}

TEST(CalibrationError, ALensErrorMovesTheFarthestCornerByItsPixels) {
  for (const FloorCamera& camera : Cameras()) {
    const bool has_tangential = camera.camera.distortion_model == DistortionModel::kPlumbBob;
    std::vector<CalibrationError> errors{{.radial_px = 0.7}, {.radial_px = -0.7}};
    if (has_tangential) {
      errors.push_back({.tangential_px = 0.7});
      errors.push_back({.tangential_px = -0.7});
    }
    for (const CalibrationError& error : errors) {
      const FloorCamera wrong = Miscalibrated(camera, error);
      const Eigen::Vector2d center(camera.camera.cx, camera.camera.cy);
      double farthest_px = 0.0, moved_px = 0.0;
      for (const Eigen::Vector2d& corner : RawCorners(camera.camera)) {
        if ((corner - center).norm() > farthest_px) {
          farthest_px = (corner - center).norm();
          moved_px = LensError(camera.camera, wrong.camera, corner).norm();
        }
      }
      EXPECT_NEAR(moved_px, 0.7, 1e-6) << "radial " << error.radial_px << ", tangential " << error.tangential_px;
    }
  }
}

TEST(CalibrationError, ARadialErrorGrowsWithTheCubeAlongTheRay) {
  const FloorCamera camera = WithoutDistortion(MakeDownwardCamera());
  const CameraModel wrong = Miscalibrated(camera, {.radial_px = 2.0}).camera;
  const Eigen::Vector2d center(camera.camera.cx, camera.camera.cy);
  const Eigen::Vector2d arm(120.0, -90.0);
  const Eigen::Vector2d near = LensError(camera.camera, wrong, center + arm);
  const Eigen::Vector2d far = LensError(camera.camera, wrong, center + 2.0 * arm);
  EXPECT_GT(near.dot(arm), 0.0) << "positive is outwards";
  EXPECT_NEAR(near.normalized().dot(arm.normalized()), 1.0, 1e-4);
  EXPECT_NEAR(far.norm() / near.norm(), 8.0, 0.02);
}

TEST(CalibrationError, ATangentialErrorGrowsWithTheSquareAndIsTheSameOnBothSides) {
  const FloorCamera camera = WithoutDistortion(MakeDownwardCamera());
  const CameraModel wrong = Miscalibrated(camera, {.tangential_px = 2.0}).camera;
  const Eigen::Vector2d center(camera.camera.cx, camera.camera.cy);
  const Eigen::Vector2d arm(120.0, -90.0);
  const Eigen::Vector2d near = LensError(camera.camera, wrong, center + arm);
  const Eigen::Vector2d far = LensError(camera.camera, wrong, center + 2.0 * arm);
  EXPECT_NEAR(far.norm() / near.norm(), 4.0, 1e-6);
  EXPECT_LT((LensError(camera.camera, wrong, center - arm) - near).norm(), 1e-6);
}

TEST(CalibrationError, ALensErrorLeavesTheOpticalAxis) {
  for (const FloorCamera& camera : Cameras()) {
    const Eigen::Vector2d axis(camera.camera.cx, camera.camera.cy);
    CalibrationError error{.radial_px = 3.0};
    if (camera.camera.distortion_model == DistortionModel::kPlumbBob) {
      error.tangential_px = 3.0;
    }
    const FloorCamera wrong = Miscalibrated(camera, error);
    EXPECT_EQ(wrong.camera.cx, camera.camera.cx);
    EXPECT_EQ(wrong.camera.fy, camera.camera.fy);
    EXPECT_LT(LensError(camera.camera, wrong.camera, axis).norm(), 1e-9);
    EXPECT_LT(FloorError(camera, wrong, axis).norm(), 1e-12);
  }
}

TEST(CalibrationError, ATiltLeavesTheLensAlone) {
  const FloorCamera camera = MakeForwardCamera();
  const FloorCamera wrong = Miscalibrated(camera, {.roll_rad = 0.01, .pitch_rad = -0.02, .height_m = 0.003});
  for (const Eigen::Vector2d& corner : RawCorners(camera.camera)) {
    EXPECT_LT(LensError(camera.camera, wrong.camera, corner).norm(), 1e-6);
  }
}

TEST(CalibrationError, OnlyDistortionShowsWrongIntrinsics) {
  for (const CalibrationError& error :
       {CalibrationError{.principal_point_px = 3.0}, CalibrationError{.focal_share = 0.005}}) {
    SCOPED_TRACE(error.focal_share);
    for (const FloorCamera& camera : Cameras()) {
      const double pixel_m = camera.floor.resolution_m;
      const Eigen::Vector2d axis(camera.camera.cx, camera.camera.cy);
      const FloorCamera wrong = Miscalibrated(camera, error);
      EXPECT_LT(FloorError(camera, wrong, axis).norm(), 1e-3 * pixel_m);
      const FloorCamera straight = WithoutDistortion(camera);
      if (camera.camera.distortion_model == DistortionModel::kPlumbBob) {
        const FloorCamera wrong_straight = Miscalibrated(straight, error);
        double shown_m = 0.0;
        for (const Eigen::Vector2d& point : PointsOfRoi(camera.floor.roi)) {
          EXPECT_LT(FloorError(straight, wrong_straight, straight.RawPixelFromFloor(point)).norm(), 1e-6 * pixel_m);
          shown_m = std::max(shown_m, FloorError(camera, wrong, camera.RawPixelFromFloor(point)).norm());
        }
        EXPECT_GT(shown_m, 0.2 * pixel_m);
      }
    }
  }
}

TEST(CalibrationError, IntrinsicsAreWrongByWhatIsAsked) {
  const CameraModel truth = MakeDownwardCamera().camera;
  const CameraModel wrong =
      Miscalibrated(MakeDownwardCamera(), {.principal_point_px = 5.0, .focal_share = -0.01}).camera;
  EXPECT_NEAR((Eigen::Vector2d(wrong.cx, wrong.cy) - Eigen::Vector2d(truth.cx, truth.cy)).norm(), 5.0, 1e-9);
  EXPECT_NEAR(wrong.fx, 0.99 * truth.fx, 1e-9);
  EXPECT_NEAR(wrong.fy, 0.99 * truth.fy, 1e-9);
}

TEST(CalibrationError, AWrongMountingDisplacesTheFloorAsItsJacobianSays) {
  constexpr double kSmall = 1e-5;
  for (const FloorCamera& camera : Cameras()) {
    const Eigen::Vector3d center = camera.CameraCenter();
    const std::vector<CalibrationError> errors{
        {.roll_rad = kSmall}, {.pitch_rad = kSmall}, {.height_m = kSmall * center.z()}};
    const std::vector<Eigen::Vector4d> mounting{
        {kSmall, 0.0, 0.0, 0.0}, {0.0, kSmall, 0.0, 0.0}, {0.0, 0.0, 0.0, kSmall}};
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const FloorCamera wrong = Miscalibrated(camera, errors[i]);
      for (const Eigen::Vector2d& point : PointsOfRoi(camera.floor.roi)) {
        const Eigen::Vector2d expected = MountingJacobian(center, point) * mounting[i];
        const Eigen::Vector2d error = FloorError(camera, wrong, camera.RawPixelFromFloor(point));
        EXPECT_LT((error - expected).norm(), 1e-3 * kSmall) << "error " << i << " at " << point.transpose();
      }
    }
  }
}

TEST(CalibrationError, AnEquidistantLensHasNoTangentialError) {
  try {
    Miscalibrated(MakeEquidistantCamera(), {.tangential_px = 0.1});
    FAIL() << "its four coefficients are all radial";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("tangential_px"));
    EXPECT_THAT(error.what(), HasSubstr("equidistant"));
  }
}

struct BadField {
  const char* name;
  double CalibrationError::*field;
  double largest;
};

TEST(CalibrationError, CheckNamesTheFieldThatIsOutOfRange) {
  const std::vector<BadField> fields{{"radial_px", &CalibrationError::radial_px, 20.0},
                                     {"tangential_px", &CalibrationError::tangential_px, 20.0},
                                     {"principal_point_px", &CalibrationError::principal_point_px, 50.0},
                                     {"focal_share", &CalibrationError::focal_share, 0.1},
                                     {"roll_rad", &CalibrationError::roll_rad, 0.1},
                                     {"pitch_rad", &CalibrationError::pitch_rad, 0.1},
                                     {"height_m", &CalibrationError::height_m, 0.05}};
  for (const BadField& bad : fields) {
    SCOPED_TRACE(bad.name);
    CalibrationError error;
    EXPECT_TRUE(error.IsZero());
    error.*bad.field = -bad.largest;
    EXPECT_FALSE(error.IsZero());
    EXPECT_NO_THROW(error.Check());
    for (const double value : {1.01 * bad.largest, -1.01 * bad.largest, std::numeric_limits<double>::quiet_NaN()}) {
      error.*bad.field = value;
      try {
        Miscalibrated(MakeDownwardCamera(), error);
        ADD_FAILURE() << "accepted " << value;
      } catch (const std::invalid_argument& refused) {
        EXPECT_THAT(refused.what(), HasSubstr(std::string(bad.name) + " must be"));
      }
    }
  }
}

TEST(CalibrationError, TheTypicalOneMovesTheCornerByItsResidual) {
  const FloorCamera camera = MakeDownwardCamera();
  const CalibrationError typical = CalibrationError::Typical(0.9, 0.002);
  EXPECT_NEAR(typical.radial_px + typical.tangential_px, 0.9, 1e-12);
  EXPECT_EQ(typical.roll_rad, 0.002);
  EXPECT_EQ(typical.pitch_rad, -0.001);
  const CameraModel wrong = Miscalibrated(camera, typical).camera;
  double largest_px = 0.0;
  for (const Eigen::Vector2d& corner : RawCorners(camera.camera)) {
    largest_px = std::max(largest_px, LensError(camera.camera, wrong, corner).norm());
  }
  EXPECT_GT(largest_px, 0.6);
  EXPECT_LE(largest_px, 0.95);
}

}  // namespace
}  // namespace floorloc
