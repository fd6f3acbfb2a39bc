// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pose_graph_factors.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

template <typename T>
T Wrap(const T& angle) {
  const T two_pi(2.0 * std::numbers::pi);
  return angle - two_pi * ceres::floor((angle + T(std::numbers::pi)) / two_pi);
}

Eigen::Matrix3d SqrtInformation(const Eigen::Matrix3d& covariance) {
  return Eigen::Matrix3d(covariance.inverse()).llt().matrixU();
}

// Whitened difference between predicted and measured first_from_second.
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

}  // namespace

ceres::Solver::Options RepeatableSolverOptions() {
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

void AddBetween(const Link& link, ceres::LossFunction* loss, PoseParameters* p, ceres::Problem* problem) {
  problem->AddResidualBlock(new ceres::AutoDiffCostFunction<BetweenError, 3, 3, 3>(
                                new BetweenError{link.first_from_second, SqrtInformation(link.covariance)}),
                            loss, (*p)[static_cast<std::size_t>(link.first)].data(),
                            (*p)[static_cast<std::size_t>(link.second)].data());
}

void AddPosePrior(const PosePriorFactor& prior, double* pose, ceres::Problem* problem) {
  problem->AddResidualBlock(new ceres::AutoDiffCostFunction<PriorError, 3, 3>(
                                new PriorError{prior.map_from_base, SqrtInformation(prior.covariance)}),
                            new ceres::CauchyLoss(kCauchyScale), pose);
}

}  // namespace floorloc
