// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/camera_adjustment.h"

#include <Eigen/Geometry>

namespace floorloc {
namespace {

constexpr double kStep = 1e-4;

}  // namespace

FloorCamera Adjusted(const FloorCamera& camera, const CameraAdjustment& adjustment) {
  FloorCamera adjusted = camera;
  const double focal = 1.0 + adjustment[static_cast<int>(CameraUnknown::kFocal)];
  CameraModel& lens = adjusted.camera;
  lens.fx *= focal;
  lens.fy *= focal;
  lens.distortion[0] += adjustment[static_cast<int>(CameraUnknown::kK1)];
  lens.distortion[1] += adjustment[static_cast<int>(CameraUnknown::kK2)];
  if (lens.distortion_model != DistortionModel::kEquidistant) {
    lens.distortion[2] += adjustment[static_cast<int>(CameraUnknown::kP1)];
    lens.distortion[3] += adjustment[static_cast<int>(CameraUnknown::kP2)];
  }
  // With the new focal length, an undistorted pixel has the ray of another pixel of the old homography.
  Eigen::Matrix3d old_pixel_from_pixel = Eigen::Matrix3d::Identity();
  old_pixel_from_pixel(0, 0) = old_pixel_from_pixel(1, 1) = 1.0 / focal;
  old_pixel_from_pixel(0, 2) = lens.cx * (1.0 - 1.0 / focal);
  old_pixel_from_pixel(1, 2) = lens.cy * (1.0 - 1.0 / focal);
  // Floor point -> ray from the camera centre -> rotated ray -> floor point below the raised centre.
  const Eigen::Vector3d center = camera.CameraCenter();
  Eigen::Matrix3d ray_from_floor;
  ray_from_floor << 1.0, 0.0, -center.x(), 0.0, 1.0, -center.y(), 0.0, 0.0, -center.z();
  const double height = center.z() * (1.0 + adjustment[static_cast<int>(CameraUnknown::kHeight)]);
  Eigen::Matrix3d floor_from_ray;
  floor_from_ray << height, 0.0, -center.x(), 0.0, height, -center.y(), 0.0, 0.0, -1.0;
  const Eigen::Vector3d rotation(adjustment[static_cast<int>(CameraUnknown::kRoll)],
                                 adjustment[static_cast<int>(CameraUnknown::kPitch)], 0.0);
  const Eigen::Matrix3d turn = rotation.norm() > 0.0
                                   ? Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix()
                                   : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  adjusted.floor.base_from_pixel =
      floor_from_ray * turn * ray_from_floor * camera.floor.base_from_pixel * old_pixel_from_pixel;
  adjusted.floor.base_from_pixel /= adjusted.floor.base_from_pixel(2, 2);
  return adjusted;
}

AdjustmentDerivative::AdjustmentDerivative(const FloorCamera& camera) {
  for (int i = 0; i < kCameraUnknowns; ++i) {
    const CameraAdjustment step = kStep * CameraAdjustment::Unit(i);
    plus_[static_cast<std::size_t>(i)] = Adjusted(camera, step);
    minus_[static_cast<std::size_t>(i)] = Adjusted(camera, -step);
  }
}

Eigen::Matrix<double, 2, kCameraUnknowns> AdjustmentDerivative::At(const Eigen::Vector2d& raw_px) const {
  Eigen::Matrix<double, 2, kCameraUnknowns> jacobian;
  for (int i = 0; i < kCameraUnknowns; ++i) {
    const auto index = static_cast<std::size_t>(i);
    jacobian.col(i) =
        (plus_[index].FloorFromRawPixel(raw_px) - minus_[index].FloorFromRawPixel(raw_px)) / (2.0 * kStep);
  }
  return jacobian;
}

}  // namespace floorloc
