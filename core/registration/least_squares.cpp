// SPDX-License-Identifier: Apache-2.0
#include "core/registration/least_squares.h"

#include <Eigen/LU>
#include <cmath>

namespace floorloc {
namespace {

const OrientedMatch& At(const std::vector<OrientedMatch>& matches, int i) {
  return matches[static_cast<std::size_t>(i)];
}

}  // namespace

std::optional<Pose2> FitRigid(const std::vector<OrientedMatch>& matches, std::span<const int> subset) {
  if (subset.size() < 2) {
    return std::nullopt;
  }
  Eigen::Vector2d source_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_mean = Eigen::Vector2d::Zero();
  for (const int i : subset) {
    source_mean += At(matches, i).source_m;
    target_mean += At(matches, i).target_m;
  }
  source_mean /= static_cast<double>(subset.size());
  target_mean /= static_cast<double>(subset.size());
  double dot = 0.0;
  double cross = 0.0;
  for (const int i : subset) {
    const Eigen::Vector2d s = At(matches, i).source_m - source_mean;
    const Eigen::Vector2d t = At(matches, i).target_m - target_mean;
    dot += s.dot(t);
    cross += s.x() * t.y() - s.y() * t.x();
  }
  constexpr double kMinMoment = 1e-12;
  if (std::hypot(dot, cross) < kMinMoment) {
    return std::nullopt;
  }
  const Pose2 turn(0.0, 0.0, std::atan2(cross, dot));
  const Eigen::Vector2d t = target_mean - turn * source_mean;
  return Pose2(t.x(), t.y(), turn.yaw());
}

std::vector<int> FindInliers(const std::vector<OrientedMatch>& matches, const Pose2& target_from_source,
                             double radius_m) {
  const Eigen::Matrix2d rotation = target_from_source.rotation();
  const Eigen::Vector2d translation = target_from_source.translation();
  std::vector<int> inliers;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector2d residual = rotation * matches[i].source_m + translation - matches[i].target_m;
    if (residual.squaredNorm() <= radius_m * radius_m) {
      inliers.push_back(static_cast<int>(i));
    }
  }
  return inliers;
}

double RmsResidual(const std::vector<OrientedMatch>& matches, std::span<const int> subset,
                   const Pose2& target_from_source) {
  double sum = 0.0;
  for (const int i : subset) {
    const OrientedMatch& m = At(matches, i);
    sum += (target_from_source * m.source_m - m.target_m).squaredNorm();
  }
  return subset.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(subset.size()));
}

Eigen::Matrix3d PoseCovariance(const std::vector<OrientedMatch>& matches, std::span<const int> subset,
                               const Pose2& target_from_source, double sigma_m) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const int i : subset) {
    // d(R s + t)/d(yaw) = the rotated point turned by 90 degrees.
    const Eigen::Vector2d rotated = target_from_source.rotation() * At(matches, i).source_m;
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian << 1.0, 0.0, -rotated.y(), 0.0, 1.0, rotated.x();
    information += jacobian.transpose() * jacobian;
  }
  return sigma_m * sigma_m * information.inverse();
}

}  // namespace floorloc
