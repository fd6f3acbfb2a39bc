// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace floorloc {
namespace {

constexpr int kMaxSidePx = 16384;

// Kannala & Brandt (2006), as OpenCV's fisheye model: theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8).
Eigen::Vector2d DistortEquidistant(const std::vector<double>& k, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < 1e-12) {
    return p;
  }
  const double theta = std::atan(r);
  const double t2 = theta * theta;
  const double theta_d = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  return p * (theta_d / r);
}

// Brown-Conrady with OpenCV's rational extension; coefficients that a model lacks are zero.
Eigen::Vector2d DistortRational(const std::vector<double>& d, const Eigen::Vector2d& p) {
  std::array<double, 8> k{};
  for (std::size_t i = 0; i < d.size() && i < k.size(); ++i) {
    k[i] = d[i];
  }
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
          y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

Eigen::Vector2d DistortNormalized(const CameraModel& camera, const Eigen::Vector2d& p) {
  return camera.distortion_model == DistortionModel::kEquidistant ? DistortEquidistant(camera.distortion, p)
                                                                  : DistortRational(camera.distortion, p);
}

// A polynomial lens model can fold: beyond some radius the distorted radius decreases again. An undistorted point is
// valid only when the distorted radius increases all the way from the centre to it.
bool IsBeforeFold(const CameraModel& camera, const Eigen::Vector2d& p) {
  constexpr int kSamples = 32;
  double previous = DistortNormalized(camera, Eigen::Vector2d::Zero()).norm();
  for (int i = 1; i <= kSamples; ++i) {
    const double radius = DistortNormalized(camera, p * (static_cast<double>(i) / kSamples)).norm();
    if (radius < previous) {
      return false;
    }
    previous = radius;
  }
  return true;
}

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

bool HasValidCount(DistortionModel model, std::size_t count) {
  switch (model) {
    case DistortionModel::kPlumbBob:
      return count == 4 || count == 5;
    case DistortionModel::kRationalPolynomial:
      return count == 8;
    case DistortionModel::kEquidistant:
      return count == 4;
  }
  return false;
}

}  // namespace

const char* ToString(DistortionModel model) {
  switch (model) {
    case DistortionModel::kPlumbBob:
      return "plumb_bob";
    case DistortionModel::kRationalPolynomial:
      return "rational_polynomial";
    case DistortionModel::kEquidistant:
      return "equidistant";
  }
  return "unknown";
}

void CameraModel::Check() const {
  Require(width_px > 0 && width_px <= kMaxSidePx, "image_width must be 1 to 16384 pixels");
  Require(height_px > 0 && height_px <= kMaxSidePx, "image_height must be 1 to 16384 pixels");
  Require(std::isfinite(fx) && fx > 0 && std::isfinite(fy) && fy > 0,
          "camera_matrix: the focal lengths (numbers 1 and 5) must be positive");
  Require(std::isfinite(cx) && std::isfinite(cy), "camera_matrix: the principal point must be finite");
  Require(HasValidCount(distortion_model, distortion.size()),
          "distortion_coefficients: plumb_bob takes 4 or 5 numbers, rational_polynomial 8, equidistant 4");
  for (const double k : distortion) {
    Require(std::isfinite(k), "distortion_coefficients must be finite");
  }
  Require(std::isfinite(sigma_px) && sigma_px >= 0, "calibration_sigma must be a number of pixels, 0 or more");
  readout.Check();
}

Eigen::Vector2d CameraModel::Distort(const Eigen::Vector2d& undistorted_px) const {
  const Eigen::Vector2d p((undistorted_px.x() - cx) / fx, (undistorted_px.y() - cy) / fy);
  const Eigen::Vector2d d = DistortNormalized(*this, p);
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Vector2d CameraModel::Undistort(const Eigen::Vector2d& raw_px) const {
  const Eigen::Vector2d target((raw_px.x() - cx) / fx, (raw_px.y() - cy) / fy);
  // Newton's method on Distort with a numeric Jacobian: a few steps reach double precision for every model.
  constexpr int kMaxSteps = 50;
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-12;
  Eigen::Vector2d p = target;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector2d error = DistortNormalized(*this, p) - target;
    if (error.norm() < kTolerance) {
      if (!IsBeforeFold(*this, p)) {
        break;
      }
      return {fx * p.x() + cx, fy * p.y() + cy};
    }
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d h = kStep * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) = (DistortNormalized(*this, p + h) - DistortNormalized(*this, p - h)) / (2.0 * kStep);
    }
    if (std::abs(jacobian.determinant()) < 1e-12) {
      break;
    }
    p -= jacobian.inverse() * error;
  }
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

bool CameraModel::Contains(const Eigen::Vector2d& raw_px) const {
  return raw_px.x() >= 0.0 && raw_px.y() >= 0.0 && raw_px.x() <= width_px - 1.0 && raw_px.y() <= height_px - 1.0;
}

}  // namespace floorloc
