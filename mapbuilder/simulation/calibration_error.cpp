// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/calibration_error.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

constexpr std::size_t kK1 = 0, kP1 = 2, kP2 = 3;
// Direction of the tangential error: p2 / p1.
constexpr double kTangentialRatio = -0.6;

Eigen::Vector2d FarthestCorner(const CameraModel& camera) {
  const double u = camera.cx > 0.5 * camera.width_px ? 0.0 : camera.width_px - 1.0;
  const double v = camera.cy > 0.5 * camera.height_px ? 0.0 : camera.height_px - 1.0;
  return {u, v};
}

// Scales a change of coefficients so that the raw image's farthest corner moves by displacement_px.
void AddLensError(const CameraModel& change, double displacement_px, CameraModel* camera) {
  const Eigen::Vector2d ray = camera->Undistort(FarthestCorner(*camera));
  const double moved_px = (change.Distort(ray) - camera->Distort(ray)).norm();
  for (std::size_t i = 0; i < camera->distortion.size(); ++i) {
    camera->distortion[i] += displacement_px / moved_px * (change.distortion[i] - camera->distortion[i]);
  }
}

void AddRadialError(double displacement_px, CameraModel* camera) {
  CameraModel change = *camera;
  change.distortion[kK1] += 1e-3;
  AddLensError(change, displacement_px, camera);
}

void AddTangentialError(double displacement_px, CameraModel* camera) {
  if (camera->distortion_model == DistortionModel::kEquidistant) {
    throw std::invalid_argument("tangential_px must be 0 for an equidistant lens: its model has no such term");
  }
  CameraModel change = *camera;
  change.distortion[kP1] += 1e-4;
  change.distortion[kP2] += 1e-4 * kTangentialRatio;
  AddLensError(change, displacement_px, camera);
}

}  // namespace

CalibrationError CalibrationError::Typical(double residual_px, double tilt_rad) {
  CalibrationError error;
  error.radial_px = residual_px * 2.0 / 3.0;
  error.tangential_px = residual_px / 3.0;
  error.roll_rad = tilt_rad;
  error.pitch_rad = -0.5 * tilt_rad;
  return error;
}

CalibrationError CalibrationError::ForCondition(const std::string& name) {
  constexpr double kResidualPx = 0.3;
  constexpr double kTiltRad = 0.1 * std::numbers::pi / 180.0;
  return name == "clean" ? CalibrationError() : Typical(kResidualPx, kTiltRad);
}

bool CalibrationError::IsZero() const {
  return radial_px == 0.0 && tangential_px == 0.0 && principal_point_px == 0.0 && focal_share == 0.0 &&
         roll_rad == 0.0 && pitch_rad == 0.0 && height_m == 0.0;
}

void CalibrationError::Check() const {
  RequireOption(std::abs(radial_px) <= 20.0, "radial_px must be -20 to 20");
  RequireOption(std::abs(tangential_px) <= 20.0, "tangential_px must be -20 to 20");
  RequireOption(std::abs(principal_point_px) <= 50.0, "principal_point_px must be -50 to 50");
  RequireOption(std::abs(focal_share) <= 0.1, "focal_share must be -0.1 to 0.1");
  RequireOption(std::abs(roll_rad) <= 0.1, "roll_rad must be -0.1 to 0.1");
  RequireOption(std::abs(pitch_rad) <= 0.1, "pitch_rad must be -0.1 to 0.1");
  RequireOption(std::abs(height_m) <= 0.05, "height_m must be -0.05 to 0.05");
}

FloorCamera Miscalibrated(const FloorCamera& camera, const CalibrationError& error) {
  error.Check();
  if (error.IsZero()) {
    return camera;
  }
  FloorCamera wrong = camera;
  CameraModel& lens = wrong.camera;
  if (error.radial_px != 0.0) {
    AddRadialError(error.radial_px, &lens);
  }
  if (error.tangential_px != 0.0) {
    AddTangentialError(error.tangential_px, &lens);
  }
  lens.cx += std::sqrt(0.5) * error.principal_point_px;
  lens.cy += std::sqrt(0.5) * error.principal_point_px;
  lens.fx *= 1.0 + error.focal_share;
  lens.fy *= 1.0 + error.focal_share;
  // Not by the intrinsics: where they put an undistorted pixel, floor.yaml was measured.
  wrong.floor.base_from_pixel = VibratedBaseFromPixel(camera, {error.pitch_rad, error.roll_rad, error.height_m});
  wrong.floor.base_from_pixel /= wrong.floor.base_from_pixel(2, 2);
  wrong.Check();
  return wrong;
}

}  // namespace floorloc
