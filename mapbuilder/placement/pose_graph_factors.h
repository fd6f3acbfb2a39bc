// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <array>
#include <vector>

#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {

/// Scale of the Cauchy loss, in standard deviations: residuals beyond it lose influence, so that false links do not
/// distort the map.
constexpr double kCauchyScale = 3.0;

/// (x, y, yaw) of every frame.
using PoseParameters = std::vector<std::array<double, 3>>;

/// What every optimisation of a map starts from: silent, and one thread, whatever --threads says. Ceres adds up costs,
/// gradients and Schur complements in the order in which its threads happen to finish, so that with two of them each
/// run of the same bundle adjustment ends elsewhere in the 13th digit, and the same survey would give another map.
/// There is little to gain: 70 to 90 % of the time goes into the linear solver, most of it CHOLMOD's, which has one
/// thread.
ceres::Solver::Options RepeatableSolverOptions();

/// The motion of a link, whitened. Takes the loss.
void AddBetween(const Link& link, ceres::LossFunction* loss, PoseParameters* poses, ceres::Problem* problem);

/// Adds an absolute pose, whitened, under a Cauchy loss.
void AddPosePrior(const PosePriorFactor& prior, double* pose, ceres::Problem* problem);

}  // namespace floorloc
