// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <array>
#include <vector>

#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {

/// Residuals beyond this many standard deviations count less and less: wrong links must not bend the map.
constexpr double kCauchyScale = 3.0;

/// x, y, yaw of every frame.
using PoseParameters = std::vector<std::array<double, 3>>;

/// The motion of a link, whitened. Takes the loss.
void AddBetween(const Link& link, ceres::LossFunction* loss, PoseParameters* poses, ceres::Problem* problem);

/// A pose known from outside, whitened, under a Cauchy loss.
void AddPosePrior(const PosePriorFactor& prior, double* pose, ceres::Problem* problem);

}  // namespace floorloc
