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

/// Adds a link's relative pose, whitened. Takes ownership of the loss.
void AddBetween(const Link& link, ceres::LossFunction* loss, PoseParameters* poses, ceres::Problem* problem);

/// Adds an absolute pose, whitened, under a Cauchy loss.
void AddPosePrior(const PosePriorFactor& prior, double* pose, ceres::Problem* problem);

}  // namespace floorloc
