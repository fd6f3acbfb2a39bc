// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>

#include "core/geometry/pose2.h"
#include "mapbuilder/self_calibration/bundle_adjustment.h"

// Residuals of the bundle adjustment, for Ceres. Parameter blocks: pose (x, y, yaw), camera, tilt, point.
namespace floorloc {

// Predicted map position of an observation.
template <typename T>
Eigen::Matrix<T, 2, 1> InMap(const Observation& observation, const T* pose, const T* camera, const T* tilt) {
  const Eigen::Map<const Eigen::Matrix<T, kCameraUnknowns, 1>> c(camera);
  const Eigen::Map<const Eigen::Matrix<T, kTiltUnknowns, 1>> t(tilt);
  const Eigen::Matrix<T, 2, 1> p =
      observation.point_in_base_m.cast<T>() + observation.by_camera.cast<T>() * c + observation.by_tilt.cast<T>() * t;
  const T cosine = ceres::cos(pose[2]);
  const T sine = ceres::sin(pose[2]);
  return {cosine * p[0] - sine * p[1] + pose[0], sine * p[0] + cosine * p[1] + pose[1]};
}

// Of an observation of an unknown floor point: pose, camera, tilt, point. Errors arise in the image, so they scale with
// the floor's scale; with a constant sigma, shrinking the floor would reduce the cost. Analytic, since a large survey
// has hundred thousands of them.
class ObservationError : public ceres::SizedCostFunction<2, 3, kCameraUnknowns, kTiltUnknowns, 2> {
 public:
  ObservationError(const Observation& observation, double sigma_m) : observation_(observation), sigma_m_(sigma_m) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* pose = parameters[0];
    const Eigen::Map<const CameraAdjustment> camera(parameters[1]);
    const Eigen::Map<const Eigen::Vector3d> tilt(parameters[2]);
    const Eigen::Map<const Eigen::Vector2d> point(parameters[3]);
    const Eigen::Matrix2d rotation = Pose2(0.0, 0.0, pose[2]).rotation();
    const Eigen::Vector2d in_base =
        observation_.point_in_base_m + observation_.by_camera * camera + observation_.by_tilt * tilt;
    const Eigen::Vector2d arm = rotation * in_base;
    const double scale = 1.0 + camera[kHeight] - camera[kFocal] + tilt[2];
    const double weight = 1.0 / (sigma_m_ * scale);
    const Eigen::Vector2d residual = weight * (arm + Eigen::Vector2d(pose[0], pose[1]) - point);
    Eigen::Map<Eigen::Vector2d> out(residuals);
    out = residual;
    if (jacobians == nullptr) {
      return true;
    }
    const Eigen::Vector2d by_scale = -residual / scale;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(jacobians[0]);
      j << weight, 0.0, -weight * arm.y(), 0.0, weight, weight * arm.x();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, kCameraUnknowns, Eigen::RowMajor>> j(jacobians[1]);
      j = weight * rotation * observation_.by_camera;
      j.col(kHeight) += by_scale;
      j.col(kFocal) -= by_scale;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, kTiltUnknowns, Eigen::RowMajor>> j(jacobians[2]);
      j = weight * rotation * observation_.by_tilt;
      j.col(2) += by_scale;
    }
    if (jacobians[3] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> j(jacobians[3]);
      j = -weight * Eigen::Matrix2d::Identity();
    }
    return true;
  }

 private:
  static constexpr int kHeight = static_cast<int>(CameraUnknown::kHeight);
  static constexpr int kFocal = static_cast<int>(CameraUnknown::kFocal);

  Observation observation_;
  double sigma_m_;
};

struct ControlError {
  ObservedControlPoint point;

  template <typename T>
  bool operator()(const T* pose, const T* camera, const T* tilt, T* residual) const {
    const Eigen::Matrix<T, 2, 1> p = InMap(point.observation, pose, camera, tilt);
    residual[0] = (p[0] - T(point.point_in_map_m.x())) / T(point.sigma_m);
    residual[1] = (p[1] - T(point.point_in_map_m.y())) / T(point.sigma_m);
    return true;
  }
};

struct DistanceError {
  ObservedDistance distance;

  // Ceres gives a residual one argument per parameter block.
  template <typename T>  // NOLINTNEXTLINE(readability-function-size)
  bool operator()(const T* pose_a, const T* camera_a, const T* tilt_a, const T* pose_b, const T* camera_b,
                  const T* tilt_b, T* residual) const {
    return Measure(InMap(distance.first, pose_a, camera_a, tilt_a), InMap(distance.second, pose_b, camera_b, tilt_b),
                   residual);
  }
  // For two frames of one camera: a Ceres residual must not use a parameter block twice.
  template <typename T>  // NOLINTNEXTLINE(readability-function-size)
  bool operator()(const T* pose_a, const T* tilt_a, const T* pose_b, const T* tilt_b, const T* camera,
                  T* residual) const {
    return Measure(InMap(distance.first, pose_a, camera, tilt_a), InMap(distance.second, pose_b, camera, tilt_b),
                   residual);
  }

 private:
  template <typename T>
  bool Measure(const Eigen::Matrix<T, 2, 1>& a, const Eigen::Matrix<T, 2, 1>& b, T* residual) const {
    const T dx = a[0] - b[0];
    const T dy = a[1] - b[1];
    residual[0] = (ceres::sqrt(dx * dx + dy * dy) - T(distance.distance_m)) / T(distance.sigma_m);
    return true;
  }
};

struct DistanceWithinFrame {
  ObservedDistance distance;

  template <typename T>
  bool operator()(const T* camera, const T* tilt, T* residual) const {
    const T still[3] = {T(0.0), T(0.0), T(0.0)};
    return DistanceError{distance}(still, tilt, still, tilt, camera, residual);
  }
};

// Zero-mean Gaussian prior on N unknowns plus a given offset.
template <int N>
struct ZeroPrior {
  Eigen::Matrix<double, N, 1> offset;
  Eigen::Matrix<double, N, 1> sigma;

  template <typename T>
  bool operator()(const T* value, T* residual) const {
    for (int i = 0; i < N; ++i) {
      residual[i] = (T(offset[i]) + value[i]) / T(sigma[i]);
    }
    return true;
  }
};

}  // namespace floorloc
