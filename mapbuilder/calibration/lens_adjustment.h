// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "mapbuilder/calibration/lens_model.h"

namespace floorloc {

/// camera_from_target: rotation vector, translation in metres.
using PoseParameters = std::array<double, 6>;

Eigen::Isometry3d ToIsometry(const PoseParameters& pose);
PoseParameters FromIsometry(const Eigen::Isometry3d& pose);

/// Points of a target and their positions in one image.
struct ObservedPoints {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Vector2d> raw_px;
};

/// Least-squares problem of a lens and the poses of targets (bundle adjustment).
struct LensAdjustment {
  DistortionModel model = DistortionModel::kPlumbBob;
  double width_px = 0.0;
  LensParameters lens{};
  std::vector<int> fixed;  ///< indices of lens parameters held constant
  std::vector<ObservedPoints> views;
  std::vector<PoseParameters> poses;  ///< camera_from_target of each view
};

using LensCovariance = Eigen::Matrix<double, kLensParameters, kLensParameters>;

struct AdjustmentSummary {
  double cost_px2 = 0.0;  ///< half the robust sum of squares
  /// Of the lens parameters in their own units, for a standard deviation of 1 px per corner coordinate; empty when the
  /// views do not determine a parameter.
  std::optional<LensCovariance> covariance;
};

/// Minimises the reprojection error over lens and poses under a Huber loss (Ceres, single-threaded).
AdjustmentSummary Adjust(LensAdjustment* problem, int max_iterations, bool with_covariance);

/// Projects the points of a target to raw pixels; NaN for points behind the camera.
std::vector<Eigen::Vector2d> Project(const LensAdjustment& problem, const PoseParameters& pose,
                                     const std::vector<Eigen::Vector3d>& points_m);

}  // namespace floorloc
