// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_sigma.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "mapbuilder/calibration/lens_model.h"

namespace floorloc {
namespace {

constexpr int kSteps = 8;  // of the grid over the image

// Of central differences of raw pixels in units of the image width, by parameters and rays of magnitude 1.
constexpr double kStep = 1e-6;

LensParameters LensOf(const CameraModel& camera) {
  const double width_px = camera.width_px;
  LensParameters lens{camera.fx / width_px, camera.fy / width_px, camera.cx / width_px, camera.cy / width_px};
  std::copy(camera.distortion.begin(), camera.distortion.end(), lens.begin() + kFirstCoefficient);
  return lens;
}

// Rays (x, y, 1) to a grid over the calibrated part of the image.
std::vector<Eigen::Vector2d> RaysOf(const CameraModel& camera, double radius_px) {
  std::vector<Eigen::Vector2d> rays;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d raw((camera.width_px - 1.0) * column / kSteps, (camera.height_px - 1.0) * row / kSteps);
      const Eigen::Vector2d px = camera.Undistort(raw);
      if (px.allFinite() && (raw - Eigen::Vector2d(camera.cx, camera.cy)).norm() <= radius_px) {
        rays.emplace_back((px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy);
      }
    }
  }
  return rays;
}

class PixelDerivatives {
 public:
  explicit PixelDerivatives(const CameraModel& camera)
      : model_(camera.distortion_model), width_px_(camera.width_px), lens_(LensOf(camera)) {}

  // Of the raw pixel of a ray.
  Eigen::Matrix<double, 2, kLensParameters> ByLens(const Eigen::Vector2d& ray) const {
    Eigen::Matrix<double, 2, kLensParameters> derivative;
    for (int i = 0; i < kLensParameters; ++i) {
      LensParameters more = lens_;
      LensParameters less = lens_;
      more[static_cast<std::size_t>(i)] += kStep;
      less[static_cast<std::size_t>(i)] -= kStep;
      derivative.col(i) = (Pixel(more, ray) - Pixel(less, ray)) / (2.0 * kStep);
    }
    return derivative;
  }

  // By the camera's translation and rotation over a plane that it looks at straight: six ways in which rays move.
  Eigen::Matrix<double, 2, 6> ByPose(const Eigen::Vector2d& ray) const {
    Eigen::Matrix2d by_ray;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(i);
      by_ray.col(i) = (Pixel(lens_, ray + step) - Pixel(lens_, ray - step)) / (2.0 * kStep);
    }
    const double x = ray.x();
    const double y = ray.y();
    Eigen::Matrix<double, 2, 6> moved;
    moved << 1.0, 0.0, x, -y, 1.0 + x * x, x * y,  //
        0.0, 1.0, y, x, x * y, 1.0 + y * y;
    return by_ray * moved;
  }

 private:
  Eigen::Vector2d Pixel(const LensParameters& lens, const Eigen::Vector2d& ray) const {
    const std::array<double, 2> pixel = ProjectThroughLens(model_, lens.data(), ray.x(), ray.y());
    return width_px_ * Eigen::Vector2d(pixel[0], pixel[1]);
  }

  DistortionModel model_;
  double width_px_;
  LensParameters lens_;
};

// Largest standard deviation of a coordinate by the lens's covariance, px.
double LensSigmaPx(const CameraModel& camera, const LensCovariance& covariance, double radius_px) {
  const std::vector<Eigen::Vector2d> rays = RaysOf(camera, radius_px);
  const PixelDerivatives derivatives(camera);
  const auto rows = 2 * static_cast<Eigen::Index>(rays.size());
  Eigen::MatrixXd by_lens(rows, kLensParameters);
  Eigen::MatrixXd by_pose(rows, 6);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    by_lens.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = derivatives.ByLens(rays[i]);
    by_pose.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = derivatives.ByPose(rays[i]);
  }
  const Eigen::MatrixXd left = by_lens - by_pose * by_pose.colPivHouseholderQr().solve(by_lens);
  double largest_px2 = 0.0;
  for (Eigen::Index row = 0; row < rows; row += 2) {
    const auto both = left.middleRows<2>(row);
    largest_px2 = std::max(largest_px2, 0.5 * (both * covariance * both.transpose()).trace());
  }
  return std::sqrt(largest_px2);
}

}  // namespace

double CalibrationSigmaPx(const CameraCalibration& calibration, double calibrated_radius_px) {
  const double residual_px = calibration.rms_px / std::sqrt(2.0);  // of a coordinate, not of a distance
  return calibration.covariance
             ? std::hypot(residual_px, LensSigmaPx(calibration.camera, *calibration.covariance, calibrated_radius_px))
             : residual_px;
}

}  // namespace floorloc
