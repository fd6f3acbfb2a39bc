// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/floor_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapbuilder/calibration/lens_adjustment.h"

namespace floorloc {
namespace {

constexpr int kMaxSteps = 100;

Eigen::Matrix3d Intrinsics(const CameraModel& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return k;
}

LensParameters ToLens(const CameraModel& camera) {
  const double width_px = camera.width_px;
  LensParameters lens{camera.fx / width_px, camera.fy / width_px, camera.cx / width_px, camera.cy / width_px};
  std::copy(camera.distortion.begin(), camera.distortion.end(), lens.begin() + kFirstCoefficient);
  return lens;
}

Eigen::Vector3d CornerInBase(const FloorCalibrationInput& input, const BoardOnFloorObservation& observation,
                             int corner) {
  const Eigen::Vector2d p = observation.base_from_board * input.board.Corner(corner);
  return {p.x(), p.y(), input.board_thickness_m};
}

ObservedPoints AllCorners(const FloorCalibrationInput& input) {
  ObservedPoints all;
  for (const BoardOnFloorObservation& observation : input.observations) {
    for (std::size_t i = 0; i < observation.view.corners.size(); ++i) {
      all.points_m.push_back(CornerInBase(input, observation, observation.view.corners[i]));
      all.raw_px.push_back(observation.view.raw_px[i]);
    }
  }
  return all;
}

PoseParameters InitialEstimate(const FloorCalibrationInput& input) {
  const BoardOnFloorObservation& first = input.observations.front();
  Eigen::Isometry3d base_from_board = Eigen::Isometry3d::Identity();
  base_from_board.linear() =
      Eigen::AngleAxisd(first.base_from_board.yaw(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  base_from_board.translation() << first.base_from_board.translation(), input.board_thickness_m;
  return FromIsometry(first.camera_from_board * base_from_board.inverse());
}

// Homography from undistorted pixels to the plane at this height above the base frame's floor.
Eigen::Matrix3d PlaneFromPixel(const CameraModel& camera, const Eigen::Isometry3d& camera_from_base, double height_m) {
  Eigen::Matrix3d columns;
  columns << camera_from_base.linear().leftCols<2>(),
      camera_from_base.translation() + height_m * camera_from_base.linear().col(2);
  return (Intrinsics(camera) * columns).inverse();
}

FloorFit MeasureFit(const FloorCalibrationInput& input, const BoardOnFloorObservation& observation,
                    const Eigen::Matrix3d& face_from_pixel) {
  FloorFit fit;
  fit.name = observation.name;
  const Eigen::Matrix3d pixel_from_face = face_from_pixel.inverse();
  double squares_px2 = 0.0;
  double squares_m2 = 0.0;
  for (std::size_t i = 0; i < observation.view.corners.size(); ++i) {
    const Eigen::Vector2d expected_m = CornerInBase(input, observation, observation.view.corners[i]).head<2>();
    const Eigen::Vector2d& observed_px = observation.view.raw_px[i];
    const Eigen::Vector2d observed_m =
        (face_from_pixel * input.camera.Undistort(observed_px).homogeneous()).hnormalized();
    const Eigen::Vector2d expected_px =
        input.camera.Distort((pixel_from_face * expected_m.homogeneous()).hnormalized());
    fit.expected_px.push_back(expected_px);
    squares_px2 += (expected_px - observed_px).squaredNorm();
    squares_m2 += (expected_m - observed_m).squaredNorm();
    fit.max_m = std::max(fit.max_m, (expected_m - observed_m).norm());
  }
  const auto count = static_cast<double>(observation.view.corners.size());
  fit.rms_px = std::sqrt(squares_px2 / count);
  fit.rms_m = std::sqrt(squares_m2 / count);
  return fit;
}

}  // namespace

double FloorCalibration::PitchDownRad() const {
  return std::asin(std::clamp(-base_from_camera.linear()(2, 2), -1.0, 1.0));
}

Eigen::Matrix3d BaseFromPixel(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera) {
  const Eigen::Matrix3d homography = PlaneFromPixel(camera, base_from_camera.inverse(), 0.0);
  const double last = homography(2, 2);
  return std::abs(last) > 1e-6 * homography.norm() ? Eigen::Matrix3d(homography / last) : homography;
}

FloorCalibration CalibrateFloor(const FloorCalibrationInput& input) {
  LensAdjustment problem;
  problem.model = input.camera.distortion_model;
  problem.width_px = input.camera.width_px;
  problem.lens = ToLens(input.camera);
  problem.fixed.resize(kLensParameters);
  std::iota(problem.fixed.begin(), problem.fixed.end(), 0);
  problem.views = {AllCorners(input)};
  problem.poses = {InitialEstimate(input)};
  Adjust(&problem, kMaxSteps, false);

  const Eigen::Isometry3d camera_from_base = ToIsometry(problem.poses.front());
  FloorCalibration result;
  result.base_from_camera = camera_from_base.inverse();
  result.base_from_pixel = BaseFromPixel(input.camera, result.base_from_camera);
  const Eigen::Matrix3d face_from_pixel = PlaneFromPixel(input.camera, camera_from_base, input.board_thickness_m);
  for (const BoardOnFloorObservation& observation : input.observations) {
    result.fits.push_back(MeasureFit(input, observation, face_from_pixel));
  }
  return result;
}

}  // namespace floorloc
