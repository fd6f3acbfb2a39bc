// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

/// Motion of the frame about its centre (x, y: map frame, m; yaw), then the camera's MountingError (rotation, height
/// share).
using MountingVector = Eigen::Matrix<double, 7, 1>;
using MountingMatrix = Eigen::Matrix<double, 7, 7>;

/// Normal equations of a frame's fit, linear about the present unknowns.
struct MountingProblem {
  MountingMatrix information = MountingMatrix::Zero();  ///< J^T W J of the residuals
  MountingVector gradient = MountingVector::Zero();     ///< J^T W r
  MountingMatrix scatter = MountingMatrix::Zero();      ///< sum of g g^T, g: gradient of one cell of the frame
  double variance = 1.0;                                ///< of a residual
  int cells = 0;                                        ///< number of cells summed in scatter; 0: many
};

struct MountingEstimate {
  MountingVector mean = MountingVector::Zero();
  MountingMatrix covariance = MountingMatrix::Identity();
};

/// One Gauss-Newton step, the mounting regularized by its loosest prior.
MountingVector MountingStep(const MountingProblem& problem, const MountingVector& unknowns);

/// Posterior of the unknowns. The level of vibration is unknown: the posteriors of several levels are averaged,
/// weighted by their evidence (Bayesian model averaging, Hoeting et al. 1999). A rotation about the plumb line is
/// indistinguishable from a turn of the robot; its uncertainty follows the level.
MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns);

}  // namespace floorloc
