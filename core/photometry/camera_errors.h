// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "core/geometry/calibration_modes.h"
#include "core/geometry/floor_plane.h"

namespace floorloc {

/// Constant errors of a camera's calibration that frames in a map can tell: rotation about the base frame's x and y
/// (rad), rise as a share of its height, then the coefficients of CalibrationModes (px). A rotation about z looks like
/// a turn of the robot.
constexpr int kCameraErrors = 3 + kCalibrationModes;
using CameraErrors = Eigen::Matrix<double, kCameraErrors, 1>;
using CameraErrorMatrix = Eigen::Matrix<double, kCameraErrors, kCameraErrors>;

/// Likelihood of a camera's errors by one frame, exp(-e^T information e / 2 + pull^T e) up to a factor.
struct CameraEvidence {
  CameraErrorMatrix information = CameraErrorMatrix::Zero();
  CameraErrors pull = CameraErrors::Zero();
  double view_radius_m = 0.0;  ///< of the visible floor
  std::size_t camera = 0;      ///< CameraKey of the calibration that the errors are relative to
};

/// What is known of a camera's errors before a frame.
struct CameraPrior {
  CameraErrors mean = CameraErrors::Zero();
  CameraErrorMatrix covariance = CameraErrorMatrix::Identity();
  std::size_t camera = 0;  ///< as in CameraEvidence
};

/// Equal for cameras whose images show the same floor at the same time, whatever their name and resolution on the
/// floor. The same in every process.
std::size_t CameraKey(const FloorCamera& camera);

/// Largest displacement of a floor point in view by the errors, beyond the mean one, which is like an offset of the
/// base; pixels of the rectified image.
double LargestDisplacementPx(const FloorCamera& camera, const CameraErrors& errors);

}  // namespace floorloc
