// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/calibration_modes.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/mounting.h"
#include "mapbuilder/simulation/calibration_error.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

constexpr int kRadial = 6, kFirstShear = 7, kSecondShear = 8;

// A step of a mode that is small beside the curvature of lens and homography.
constexpr double kUnits = 1e-3;

class CalibrationModesTest : public ::testing::TestWithParam<const char*> {
 protected:
  CalibrationModesTest() {
    const RectM& roi = camera_.floor.roi;
    for (const double x : {roi.x_min, roi.x_max}) {
      for (const double y : {roi.y_min, roi.y_max}) {
        const Eigen::Vector2d px = camera_.RawPixelFromFloor({x, y});
        const CameraModel& lens = camera_.camera;
        corners_px_.emplace_back(std::clamp(px.x(), 0.0, lens.width_px - 1.0),
                                 std::clamp(px.y(), 0.0, lens.height_px - 1.0));
      }
    }
    farthest_px_ = *std::max_element(corners_px_.begin(), corners_px_.end(), [this](const auto& a, const auto& b) {
      return (a - center_px_).norm() < (b - center_px_).norm();
    });
  }

  static FloorCamera NamedCamera(const std::string& name) {
    return name == "down" ? MakeDownwardCamera() : name == "forward" ? MakeForwardCamera() : MakeEquidistantCamera();
  }

  // Where the raw pixel is, of which the floor point is displaced as one unit of the mode says: pixels per unit.
  Eigen::Vector2d PixelShift(const Eigen::Vector2d& raw_px, int mode) const {
    const Eigen::Vector2d point = camera_.FloorFromRawPixel(raw_px);
    const Eigen::Vector2d step = kUnits * modes_.At(point).col(mode);
    return (camera_.RawPixelFromFloor(point + step) - camera_.RawPixelFromFloor(point - step)) / (2.0 * kUnits);
  }

  // From the principal point towards the farthest corner.
  Eigen::Vector2d Along(double share) const { return center_px_ + share * (farthest_px_ - center_px_); }

  std::vector<Eigen::Vector2d> Grid() const {
    std::vector<Eigen::Vector2d> points;
    const RectM& roi = camera_.floor.roi;
    for (int i = 1; i < 8; ++i) {
      for (int k = 1; k < 8; ++k) {
        points.emplace_back(roi.x_min + i * roi.width_m() / 8.0, roi.y_min + k * roi.height_m() / 8.0);
      }
    }
    return points;
  }

  const FloorCamera camera_ = NamedCamera(GetParam());
  const CalibrationModes modes_{camera_};
  const Eigen::Vector2d center_px_{camera_.camera.cx, camera_.camera.cy};
  std::vector<Eigen::Vector2d> corners_px_;  // of the region of interest, as far as the image shows it
  Eigen::Vector2d farthest_px_ = Eigen::Vector2d::Zero();
};

TEST_P(CalibrationModesTest, AUnitMovesTheFarthestCornerByAPixel) {
  for (const int mode : {kRadial, kFirstShear, kSecondShear}) {
    EXPECT_NEAR(PixelShift(farthest_px_, mode).norm(), 1.0, 1e-3) << "mode " << mode;
  }
  // A quadratic mode does so along its own axis; the three of an axis span a pixel at any corner.
  for (const int first : {0, 3}) {
    const double xx = PixelShift(farthest_px_, first).norm();
    const double yy = PixelShift(farthest_px_, first + 2).norm();
    EXPECT_NEAR(xx + yy, 1.0, 1e-3) << "modes " << first << " and " << first + 2;
    EXPECT_NEAR(PixelShift(farthest_px_, first + 1).norm(), 2.0 * std::sqrt(xx * yy), 1e-3);
  }
  for (const Eigen::Vector2d& corner : corners_px_) {
    for (int mode = 0; mode < kCalibrationModes; ++mode) {
      EXPECT_LT(PixelShift(corner, mode).norm(), 1.01) << "mode " << mode << " at " << corner.transpose();
    }
  }
}

// Displacement of the raw image by one unit of a mode, as the header has them; q: relative to the principal point, 1 at
// the farthest corner.
Eigen::Vector2d ImageShift(int mode, const Eigen::Vector2d& q) {
  if (mode == kRadial) {
    return q.squaredNorm() * q;
  }
  if (mode == kFirstShear) {
    return {q.x(), -q.y()};
  }
  if (mode == kSecondShear) {
    return {q.y(), q.x()};
  }
  const Eigen::Vector3d squares(q.x() * q.x(), 2.0 * q.x() * q.y(), q.y() * q.y());
  return squares(mode % 3) * Eigen::Vector2d::Unit(mode / 3);
}

TEST_P(CalibrationModesTest, AFloorPointGoesWhereItsMovedPixelLooks) {
  const double radius_px = (farthest_px_ - center_px_).norm();
  for (const Eigen::Vector2d& point : Grid()) {
    const Eigen::Vector2d raw_px = camera_.RawPixelFromFloor(point);
    for (int mode = 0; mode < kCalibrationModes; ++mode) {
      const Eigen::Vector2d step = kUnits * ImageShift(mode, (raw_px - center_px_) / radius_px);
      const Eigen::Vector2d moved = camera_.FloorFromRawPixel(raw_px + step) - camera_.FloorFromRawPixel(raw_px - step);
      EXPECT_LT((moved / (2.0 * kUnits) - modes_.At(point).col(mode)).norm(), 1e-3 * camera_.floor.resolution_m)
          << "mode " << mode << " at " << raw_px.transpose();
    }
  }
}

TEST_P(CalibrationModesTest, TheyGrowFromNothingAsTheirOrderSays) {
  constexpr std::array<double, kCalibrationModes> kOrder{2, 2, 2, 2, 2, 2, 3, 1, 1};
  for (int mode = 0; mode < kCalibrationModes; ++mode) {
    // Up to what interpolation between the nodes leaves.
    EXPECT_LT(PixelShift(center_px_, mode).norm(), 3e-3) << "mode " << mode;
    const double growth = PixelShift(Along(0.9), mode).norm() / PixelShift(Along(0.45), mode).norm();
    EXPECT_NEAR(growth / std::pow(2.0, kOrder[static_cast<std::size_t>(mode)]), 1.0, 0.05) << "mode " << mode;
  }
}

TEST_P(CalibrationModesTest, TheRadialOneMovesAlongTheRay) {
  for (const Eigen::Vector2d& corner : corners_px_) {
    const Eigen::Vector2d arm = corner - center_px_;
    EXPECT_NEAR(PixelShift(corner, kRadial).normalized().dot(arm.normalized()), 1.0, 1e-4);
  }
}

// What the modes cannot explain of a displacement of the raw image, as a share of it.
template <typename Displacement>
double Unexplained(const std::vector<Eigen::Vector2d>& pixels, const Eigen::MatrixXd& modes,
                   const Displacement& displacement) {
  Eigen::VectorXd wanted(2 * static_cast<Eigen::Index>(pixels.size()));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    wanted.segment<2>(2 * static_cast<Eigen::Index>(i)) = displacement(pixels[i]);
  }
  const Eigen::VectorXd fit = modes * (modes.transpose() * modes).ldlt().solve(modes.transpose() * wanted);
  return (wanted - fit).norm() / wanted.norm();
}

TEST_P(CalibrationModesTest, TheyAreIndependentAndHoldNoMotionOfTheRobot) {
  std::vector<Eigen::Vector2d> pixels;
  for (int i = -4; i <= 4; ++i) {
    for (int k = -4; k <= 4; ++k) {  // symmetric about the principal point
      pixels.push_back(center_px_ + Eigen::Vector2d(30.0 * i, 25.0 * k));
    }
  }
  Eigen::MatrixXd columns(2 * static_cast<Eigen::Index>(pixels.size()), kCalibrationModes);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (int mode = 0; mode < kCalibrationModes; ++mode) {
      columns.col(mode).segment<2>(2 * static_cast<Eigen::Index>(i)) = PixelShift(pixels[i], mode);
    }
  }
  for (int mode = 0; mode < kCalibrationModes; ++mode) {
    columns.col(mode).normalize();
  }
  EXPECT_GT((columns.transpose() * columns).determinant(), 1e-3);
  using Pixel = const Eigen::Vector2d&;
  EXPECT_GT(Unexplained(pixels, columns, [](Pixel) { return Eigen::Vector2d(1.0, 0.0); }), 0.3);
  EXPECT_GT(Unexplained(pixels, columns, [](Pixel) { return Eigen::Vector2d(0.0, 1.0); }), 0.3);
  EXPECT_GT(Unexplained(pixels, columns, [&](Pixel p) { return Eigen::Vector2d(p - center_px_); }), 0.2);
  const auto turned = [&](Pixel p) { return Eigen::Vector2d(center_px_.y() - p.y(), p.x() - center_px_.x()); };
  EXPECT_GT(Unexplained(pixels, columns, turned), 0.9);
}

// All but a tenth of them, beside the motion and the mounting that are estimated anyway.
TEST_P(CalibrationModesTest, TheyExplainWrongLenses) {
  std::vector<CalibrationError> errors{{.radial_px = 0.5}};
  if (camera_.camera.distortion_model == DistortionModel::kPlumbBob) {
    errors.push_back({.tangential_px = 0.5});
    errors.push_back({.principal_point_px = 1.0});
  }
  for (const CalibrationError& error : errors) {
    const FloorCamera wrong = Miscalibrated(camera_, error);
    const std::vector<Eigen::Vector2d> points = Grid();
    const auto rows = 2 * static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd explain(rows, kCalibrationModes + 7);
    Eigen::VectorXd displaced(rows);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto row = 2 * static_cast<Eigen::Index>(i);
      Eigen::Matrix<double, 2, 3> motion;
      motion << 1.0, 0.0, -points[i].y(), 0.0, 1.0, points[i].x();
      explain.middleRows<2>(row) << modes_.At(points[i]), motion, MountingJacobian(camera_.CameraCenter(), points[i]);
      displaced.segment<2>(row) = wrong.FloorFromRawPixel(camera_.RawPixelFromFloor(points[i])) - points[i];
    }
    const Eigen::VectorXd left = displaced - explain * explain.completeOrthogonalDecomposition().solve(displaced);
    EXPECT_GT(displaced.norm(), 0.0);
    EXPECT_LT(left.norm() / displaced.norm(), 0.1)
        << "radial " << error.radial_px << " tangential " << error.tangential_px;
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, CalibrationModesTest, ::testing::Values("down", "forward", "equidistant"));

}  // namespace
}  // namespace floorloc
