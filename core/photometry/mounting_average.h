// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/calibration_modes.h"
#include "core/photometry/camera_errors.h"

namespace floorloc {

/// Motion of the frame about its centre (x, y: map frame, m; yaw), then the camera's MountingError (rotation, height
/// share).
using MountingVector = Eigen::Matrix<double, 7, 1>;
using MountingMatrix = Eigen::Matrix<double, 7, 7>;

/// Normal equations of a frame's fit, linear about the present unknowns and a calibration without errors. J: Jacobian
/// of the pixels with respect to the unknowns, L: with respect to the calibration's modes.
struct MountingProblem {
  MountingMatrix information = MountingMatrix::Zero();  ///< J^T W J of the residuals
  MountingVector gradient = MountingVector::Zero();     ///< J^T W r
  MountingMatrix scatter = MountingMatrix::Zero();      ///< sum of g g^T, g: gradient of one cell of the frame
  double variance = 1.0;                                ///< of a residual
  /// J^T W L, L^T W L, L^T W r. Zero: the calibration is taken as exact.
  Eigen::Matrix<double, 7, kCalibrationModes> by_calibration = Eigen::Matrix<double, 7, kCalibrationModes>::Zero();
  Eigen::Matrix<double, kCalibrationModes, kCalibrationModes> calibration_information =
      Eigen::Matrix<double, kCalibrationModes, kCalibrationModes>::Zero();
  Eigen::Matrix<double, kCalibrationModes, 1> calibration_gradient =
      Eigen::Matrix<double, kCalibrationModes, 1>::Zero();
  int cells = 0;  ///< number of cells summed in scatter; 0: many
  /// The same of the motion (x, y, yaw of the view's centre: base frame, m and rad) by which the rows of a rolling
  /// shutter were put where they belong, R: J^T W R and L^T W R, R^T W R, R^T W r. readout_sigma: its standard
  /// deviation; zero: it is exact.
  Eigen::Matrix<double, 7 + kCalibrationModes, 3> by_readout = Eigen::Matrix<double, 7 + kCalibrationModes, 3>::Zero();
  Eigen::Matrix3d readout_information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d readout_gradient = Eigen::Vector3d::Zero();
  Eigen::Vector3d readout_sigma = Eigen::Vector3d::Zero();
};

struct MountingEstimate {
  MountingVector mean = MountingVector::Zero();
  MountingMatrix covariance = MountingMatrix::Identity();
  double vibration = 0.0;  ///< its standard deviation: radians of each rotation, share of the camera's height
};

/// One Gauss-Newton step, the mounting regularized by its loosest prior.
MountingVector MountingStep(const MountingProblem& problem, const MountingVector& unknowns);

/// Posterior of the unknowns, marginalized over the motion of rows, and over the calibration's errors: a lens that
/// bends the image a little looks like a tilted camera, so the tilt is only as certain as the calibration. The levels
/// of vibration and of the calibration's errors are unknown: the posteriors of several levels are averaged, weighted by
/// their evidence (Bayesian model averaging, Hoeting et al. 1999). A rotation about the plumb line is indistinguishable
/// from a turn of the robot; its uncertainty follows the level. calibration_sigma_px: standard deviation of the
/// calibration at the corners of the region of interest, uncertain by a factor of two; 0: exact.
MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns,
                                     double calibration_sigma_px = 0.0);

/// The same with a camera whose constant errors are known: vibration is about them.
MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns,
                                     const CameraPrior& camera);

/// What the frame tells of its camera's constant errors: its likelihood, marginalized over the motion, the vibration
/// and errors of the mosaic, which look like calibration modes that change from place to place. mosaic_sigma_px: their
/// standard deviation at the corners of the view.
CameraEvidence EvidenceOfCamera(const MountingProblem& problem, const MountingVector& unknowns, double vibration,
                                double mosaic_sigma_px);

}  // namespace floorloc
