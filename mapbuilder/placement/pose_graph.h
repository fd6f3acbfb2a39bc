// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/link.h"

namespace floorloc {

/// Absolute pose measurement of a frame (unary factor).
struct PosePriorFactor {
  int frame = 0;
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive
};

/// Surveyed map position of a floor point of a frame.
struct ControlPointFactor {
  int frame = 0;
  Eigen::Vector2d point_in_base_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d point_in_map_m = Eigen::Vector2d::Zero();
  double sigma_m = 1e-3;
};

/// Unknown poses and all measurements of them. Frames without any factor keep their pose.
struct PoseGraph {
  std::vector<Pose2> map_from_base;
  std::vector<Link> links;     ///< between frames, from images
  std::vector<Link> odometry;  ///< between frames, from wheel odometry
  std::vector<PosePriorFactor> priors;
  std::vector<ControlPointFactor> control_points;
  std::vector<int> fixed;  ///< frames that do not move

  std::vector<Link> LinksAndOdometry() const;
};

struct PoseGraphSummary {
  bool converged = false;
  double rms_sigma = 0.0;  ///< residuals of the links, in standard deviations
};

/// Optimises all poses under a Cauchy loss (Ceres, sparse Cholesky; single-threaded, for a fixed order of summation).
PoseGraphSummary OptimizePoses(PoseGraph* graph);

/// The same with the squared residual of every link multiplied by its weight and no loss on links; odometry, priors and
/// control points keep theirs. weights: one per link, >= 0.
PoseGraphSummary OptimizePosesWeighted(PoseGraph* graph, const std::vector<double>& weights);

struct LinkStatistics {
  double rms_m = 0.0;      ///< keypoint residual
  double rms_sigma = 0.0;  ///< residual under the poses, in standard deviations
};

/// Over the links both of whose frames have poses.
LinkStatistics MeasureLinks(const std::vector<Link>& links, const std::vector<std::optional<Pose2>>& map_from_base);

/// Residual of a link in standard deviations: sqrt(e^T Sigma^-1 e).
double LinkResidual(const Link& link, const Pose2& map_from_first, const Pose2& map_from_second);

}  // namespace floorloc
