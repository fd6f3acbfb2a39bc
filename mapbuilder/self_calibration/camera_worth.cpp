// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/camera_worth.h"

#include <algorithm>
#include <cmath>

#include "mapbuilder/self_calibration/observation_builder.h"

namespace floorloc {
namespace {

// Standard deviation of a floor point's displacement by the camera's unknowns, metres; root mean square of both axes.
double DisplacementSigma(const DerivativeGrid::Jacobian& jacobian, const CameraCovariance& covariance) {
  return std::sqrt(0.5 * (jacobian * covariance * jacobian.transpose()).trace());
}

// Side of a raw pixel on the floor at the centre of the region of interest, metres.
double PixelFootprint(const FloorCamera& camera) {
  const Eigen::Vector2d center = camera.floor.roi.Center();
  const Eigen::Vector2d raw = camera.RawPixelFromFloor(center);
  const Eigen::Vector2d right = camera.FloorFromRawPixel(raw + Eigen::Vector2d(1.0, 0.0)) - center;
  const Eigen::Vector2d down = camera.FloorFromRawPixel(raw + Eigen::Vector2d(0.0, 1.0)) - center;
  return std::sqrt(std::abs(right.x() * down.y() - right.y() * down.x()));
}

}  // namespace

FloorCamera WithSigmas(FloorCamera camera, const CameraCovariance& covariance, double unmodelled_px) {
  const DerivativeGrid derivative(camera);
  const RectM& roi = camera.floor.roi;
  const DerivativeGrid::Jacobian center = derivative.At(roi.Center());
  double largest_m = 0.0;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      const DerivativeGrid::Jacobian corner = derivative.At({x, y}) - center;
      const double sigma_m = DisplacementSigma(corner, covariance);
      largest_m = std::isfinite(sigma_m) ? std::max(largest_m, sigma_m) : largest_m;
    }
  }
  camera.camera.sigma_px = std::hypot(largest_m / PixelFootprint(camera), unmodelled_px);
  camera.floor.offset_sigma_m = DisplacementSigma(center, covariance);
  return camera;
}

}  // namespace floorloc
