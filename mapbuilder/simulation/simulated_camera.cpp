// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// x_in_camera = camera_from_base * (x_in_base - position). Camera frame: x right, y down, z forward.
struct CameraPose {
  Eigen::Matrix3d camera_from_base = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

Eigen::Matrix3d Intrinsics(const CameraModel& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return k;
}

// Floor point (x, y, 1) in the base frame -> undistorted pixel.
Eigen::Matrix3d PixelFromBase(const CameraModel& camera, const CameraPose& pose) {
  Eigen::Matrix3d columns;
  columns.col(0) = pose.camera_from_base.col(0);
  columns.col(1) = pose.camera_from_base.col(1);
  columns.col(2) = -pose.camera_from_base * pose.position;
  return Intrinsics(camera) * columns;
}

CameraPose RecoverPose(const FloorCamera& camera) {
  Eigen::Matrix3d columns = Intrinsics(camera.camera).inverse() * camera.floor.base_from_pixel.inverse();
  columns /= 0.5 * (columns.col(0).norm() + columns.col(1).norm());
  if (columns.row(2) * camera.floor.roi.Center().homogeneous() < 0.0) {
    columns = -columns;  // the floor must be in front of the camera
  }
  Eigen::Matrix3d rotation;
  rotation << columns.col(0), columns.col(1), columns.col(0).cross(columns.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  CameraPose pose;
  pose.camera_from_base = svd.matrixU() * svd.matrixV().transpose();
  pose.position = -pose.camera_from_base.transpose() * columns.col(2);
  return pose;
}

CameraPose MountedPose(double forward_m, double height_m, double pitch_down_rad) {
  const double c = std::cos(pitch_down_rad);
  const double s = std::sin(pitch_down_rad);
  CameraPose pose;
  pose.camera_from_base << 0.0, -1.0, 0.0, -s, 0.0, -c, c, 0.0, -s;
  pose.position = {forward_m, 0.0, height_m};
  return pose;
}

FloorCamera Mount(const CameraModel& camera, const CameraPose& pose, const RectM& roi, double resolution_m) {
  FloorCamera mounted;
  mounted.camera = camera;
  mounted.floor.base_from_pixel = PixelFromBase(camera, pose).inverse();
  mounted.floor.base_from_pixel /= mounted.floor.base_from_pixel(2, 2);
  mounted.floor.roi = roi;
  mounted.floor.resolution_m = resolution_m;
  mounted.Check();
  return mounted;
}

CameraModel PlumbBobLens() {
  return {"simulated",
          640,
          480,
          598.3,
          597.6,
          322.4,
          238.7,
          DistortionModel::kPlumbBob,
          {-0.25, 0.06, 0.0008, -0.0005, 0.0}};
}

// Scales the rectangle with the height about the point below the camera; rounded to micrometres to keep floor.yaml
// readable.
RectM RoiAt(double forward_m, double scale, const RectM& relative) {
  const auto rounded = [](double metres) { return std::round(metres * 1e6) / 1e6; };
  return {rounded(forward_m + scale * relative.x_min), rounded(forward_m + scale * relative.x_max),
          rounded(scale * relative.y_min), rounded(scale * relative.y_max)};
}

}  // namespace

FloorCamera MakeDownwardCamera(double height_m) {
  constexpr double kForwardM = 0.2;
  const double scale = height_m / 0.4;
  return Mount(PlumbBobLens(), MountedPose(kForwardM, height_m, 0.5 * std::numbers::pi),
               RoiAt(kForwardM, scale, {-0.155, 0.155, -0.205, 0.21}), 0.0007 * scale);
}

FloorCamera MakeForwardCamera(double height_m) {
  constexpr double kForwardM = 0.12;
  constexpr double kPitchDownRad = 50.0 * std::numbers::pi / 180.0;
  const double scale = height_m / 0.35;
  return Mount(PlumbBobLens(), MountedPose(kForwardM, height_m, kPitchDownRad),
               RoiAt(kForwardM, scale, {0.125, 0.515, -0.18, 0.185}), 0.0008 * scale);
}

FloorCamera MakeEquidistantCamera(double height_m) {
  constexpr double kForwardM = 0.2;
  const double scale = height_m / 0.3;
  const CameraModel fisheye{
      "simulated", 640, 480, 401.2, 400.7, 321.1, 239.4, DistortionModel::kEquidistant, {-0.02, 0.004, -0.001, 0.0}};
  return Mount(fisheye, MountedPose(kForwardM, height_m, 0.5 * std::numbers::pi),
               RoiAt(kForwardM, scale, {-0.17, 0.17, -0.22, 0.22}), 0.0008 * scale);
}

Eigen::Matrix3d VibratedBaseFromPixel(const FloorCamera& camera, const CameraVibration& vibration) {
  const CameraPose calibrated = RecoverPose(camera);
  CameraPose moved = calibrated;
  const Eigen::Matrix3d tilt = (Eigen::AngleAxisd(vibration.pitch_rad, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(vibration.roll_rad, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  moved.camera_from_base = calibrated.camera_from_base * tilt.transpose();
  moved.position.z() += vibration.height_m;
  // Relative to the given homography, so that zero vibration reproduces it exactly even if it is not that of a perfect
  // pinhole camera.
  return camera.floor.base_from_pixel * PixelFromBase(camera.camera, calibrated) *
         PixelFromBase(camera.camera, moved).inverse();
}

}  // namespace floorloc
