// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <cmath>

#include "mapbuilder/placement/pose_graph_factors.h"

namespace floorloc {
namespace {

struct ControlPointError {
  ControlPointFactor factor;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const T c = ceres::cos(pose[2]);
    const T s = ceres::sin(pose[2]);
    const T x = T(factor.point_in_base_m.x());
    const T y = T(factor.point_in_base_m.y());
    residual[0] = (c * x - s * y + pose[0] - T(factor.point_in_map_m.x())) / T(factor.sigma_m);
    residual[1] = (s * x + c * y + pose[1] - T(factor.point_in_map_m.y())) / T(factor.sigma_m);
    return true;
  }
};

// weights: one per link; empty: robust loss instead.
void AddFactors(const PoseGraph& graph, const std::vector<double>& weights, PoseParameters* p,
                ceres::Problem* problem) {
  const auto block = [&](int frame) { return (*p)[static_cast<std::size_t>(frame)].data(); };
  for (std::size_t i = 0; i < graph.links.size(); ++i) {
    if (weights.empty()) {
      AddBetween(graph.links[i], new ceres::CauchyLoss(kCauchyScale), p, problem);
    } else if (weights[i] > 0.0) {
      AddBetween(graph.links[i], new ceres::ScaledLoss(nullptr, weights[i], ceres::TAKE_OWNERSHIP), p, problem);
    }
  }
  for (const Link& link : graph.odometry) {
    AddBetween(link, new ceres::CauchyLoss(kCauchyScale), p, problem);
  }
  for (const PosePriorFactor& prior : graph.priors) {
    AddPosePrior(prior, block(prior.frame), problem);
  }
  for (const ControlPointFactor& factor : graph.control_points) {
    problem->AddResidualBlock(new ceres::AutoDiffCostFunction<ControlPointError, 2, 3>(new ControlPointError{factor}),
                              new ceres::CauchyLoss(kCauchyScale), block(factor.frame));
  }
  for (const int frame : graph.fixed) {
    if (problem->HasParameterBlock(block(frame))) {
      problem->SetParameterBlockConstant(block(frame));
    }
  }
}

}  // namespace

double LinkResidual(const Link& link, const Pose2& map_from_first, const Pose2& map_from_second) {
  const Pose2 predicted = map_from_first.Between(map_from_second);
  const Eigen::Vector3d error(predicted.x() - link.first_from_second.x(), predicted.y() - link.first_from_second.y(),
                              WrapAngle(predicted.yaw() - link.first_from_second.yaw()));
  return std::sqrt(error.dot(link.covariance.inverse() * error));
}

namespace {

PoseGraphSummary Solve(PoseGraph* graph, const std::vector<double>& weights) {
  PoseParameters parameters;
  for (const Pose2& pose : graph->map_from_base) {
    parameters.push_back({pose.x(), pose.y(), pose.yaw()});
  }
  ceres::Problem problem;
  AddFactors(*graph, weights, &parameters, &problem);
  PoseGraphSummary result;
  if (problem.NumResidualBlocks() == 0) {
    result.converged = true;
    return result;
  }
  ceres::Solver::Options options = RepeatableSolverOptions();
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 100;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    graph->map_from_base[i] = Pose2(parameters[i][0], parameters[i][1], parameters[i][2]);
  }
  double sum = 0.0;
  for (const Link& link : graph->links) {
    const double r = LinkResidual(link, graph->map_from_base[static_cast<std::size_t>(link.first)],
                                  graph->map_from_base[static_cast<std::size_t>(link.second)]);
    sum += r * r;
  }
  result.converged = summary.IsSolutionUsable();
  result.rms_sigma = graph->links.empty() ? 0.0 : std::sqrt(sum / (3.0 * static_cast<double>(graph->links.size())));
  return result;
}

}  // namespace

std::vector<Link> PoseGraph::LinksAndOdometry() const {
  std::vector<Link> all = links;
  all.insert(all.end(), odometry.begin(), odometry.end());
  return all;
}

PoseGraphSummary OptimizePoses(PoseGraph* graph) { return Solve(graph, {}); }

PoseGraphSummary OptimizePosesWeighted(PoseGraph* graph, const std::vector<double>& weights) {
  return Solve(graph, weights);
}

LinkStatistics MeasureLinks(const std::vector<Link>& links, const std::vector<std::optional<Pose2>>& map_from_base) {
  LinkStatistics sums;
  int count = 0;
  for (const Link& link : links) {
    const auto& first = map_from_base[static_cast<std::size_t>(link.first)];
    const auto& second = map_from_base[static_cast<std::size_t>(link.second)];
    if (first && second) {
      const double sigmas = LinkResidual(link, *first, *second);
      sums.rms_m += link.rms_m * link.rms_m;
      sums.rms_sigma += sigmas * sigmas / 3.0;
      ++count;
    }
  }
  if (count > 0) {
    sums.rms_m = std::sqrt(sums.rms_m / count);
    sums.rms_sigma = std::sqrt(sums.rms_sigma / count);
  }
  return sums;
}

}  // namespace floorloc
