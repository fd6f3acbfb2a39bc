// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// Residuals beyond this many standard deviations count less and less: wrong links must not bend the map.
constexpr double kCauchyScale = 3.0;

template <typename T>
T Wrap(const T& angle) {
  const T two_pi(2.0 * std::numbers::pi);
  return angle - two_pi * ceres::floor((angle + T(std::numbers::pi)) / two_pi);
}

Eigen::Matrix3d SqrtInformation(const Eigen::Matrix3d& covariance) {
  return Eigen::Matrix3d(covariance.inverse()).llt().matrixU();
}

// first_from_second as predicted by two poses minus as measured, whitened.
struct BetweenError {
  Pose2 measured;
  Eigen::Matrix3d sqrt_information;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const T c = ceres::cos(a[2]);
    const T s = ceres::sin(a[2]);
    const T dx = b[0] - a[0];
    const T dy = b[1] - a[1];
    const Eigen::Matrix<T, 3, 1> error(c * dx + s * dy - T(measured.x()), -s * dx + c * dy - T(measured.y()),
                                       Wrap(b[2] - a[2] - T(measured.yaw())));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> out(residual);
    out = sqrt_information.cast<T>() * error;
    return true;
  }
};

struct PriorError {
  Pose2 measured;
  Eigen::Matrix3d sqrt_information;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const Eigen::Matrix<T, 3, 1> error(pose[0] - T(measured.x()), pose[1] - T(measured.y()),
                                       Wrap(pose[2] - T(measured.yaw())));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> out(residual);
    out = sqrt_information.cast<T>() * error;
    return true;
  }
};

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

using Parameters = std::vector<std::array<double, 3>>;

void AddFactors(const PoseGraph& graph, Parameters* p, ceres::Problem* problem) {
  const auto block = [&](int frame) { return (*p)[static_cast<std::size_t>(frame)].data(); };
  const auto between = [&](const Link& link) {
    problem->AddResidualBlock(new ceres::AutoDiffCostFunction<BetweenError, 3, 3, 3>(
                                  new BetweenError{link.first_from_second, SqrtInformation(link.covariance)}),
                              new ceres::CauchyLoss(kCauchyScale), block(link.first), block(link.second));
  };
  for (const Link& link : graph.links) {
    between(link);
  }
  for (const Link& link : graph.odometry) {
    between(link);
  }
  for (const PosePriorFactor& prior : graph.priors) {
    problem->AddResidualBlock(new ceres::AutoDiffCostFunction<PriorError, 3, 3>(
                                  new PriorError{prior.map_from_base, SqrtInformation(prior.covariance)}),
                              new ceres::CauchyLoss(kCauchyScale), block(prior.frame));
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

PoseGraphSummary OptimizePoses(PoseGraph* graph) {
  Parameters parameters;
  for (const Pose2& pose : graph->map_from_base) {
    parameters.push_back({pose.x(), pose.y(), pose.yaw()});
  }
  ceres::Problem problem;
  AddFactors(*graph, &parameters, &problem);
  PoseGraphSummary result;
  if (problem.NumResidualBlocks() == 0) {
    result.converged = true;
    return result;
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
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

}  // namespace floorloc
