// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/frame_offset.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/evaluation/fix_score.h"

namespace floorloc {
namespace {

constexpr double kLeverM = 0.25;
constexpr int kIterations = 10;
constexpr double kStep = 1e-6;

// Prior weight of a base offset of zero, in poses: with one heading only, the offset is not observable.
constexpr double kLoose = 1e-6;
constexpr double kHeld = 1e9;

// log scale; x, y, yaw of truth_from_map; x, y of the base.
using Parameters = Eigen::Matrix<double, 6, 1>;

FrameOffset FromParameters(const Parameters& p) { return {std::exp(p(0)), {p(1), p(2), p(3)}, {p(4), p(5), 0.0}}; }

Eigen::Vector3d Residual(const PoseAndTruth& pose, const FrameOffset& offset) {
  const Pose2 mapped = offset.Apply(pose.map_from_base);
  return {mapped.x() - pose.truth_from_base.x(), mapped.y() - pose.truth_from_base.y(),
          kLeverM * WrapAngle(mapped.yaw() - pose.truth_from_base.yaw())};
}

// The pose's truth relative to the first pose's, so that the first iteration starts near the solution.
Parameters Start(const PoseAndTruth& first) {
  const Pose2 truth_from_map = first.truth_from_base * first.map_from_base.Inverse();
  return (Parameters() << 0.0, truth_from_map.x(), truth_from_map.y(), truth_from_map.yaw(), 0.0, 0.0).finished();
}

bool HaveOneHeading(const std::vector<PoseAndTruth>& poses) {
  constexpr double kMinResultant = 0.95;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const PoseAndTruth& pose : poses) {
    sum += Eigen::Vector2d(std::cos(pose.truth_from_base.yaw()), std::sin(pose.truth_from_base.yaw()));
  }
  return sum.norm() > kMinResultant * static_cast<double>(poses.size());
}

}  // namespace

Pose2 FrameOffset::Apply(const Pose2& map_from_base) const {
  const Pose2 scaled(scale * map_from_base.x(), scale * map_from_base.y(), map_from_base.yaw());
  return truth_from_map * scaled * base_from_camera_base;
}

FrameOffset FitFrameOffset(const std::vector<PoseAndTruth>& poses) {
  if (poses.size() < 3) {
    throw std::invalid_argument("a frame offset needs at least three poses");
  }
  const double offset_weight = HaveOneHeading(poses) ? kHeld : kLoose;
  Parameters parameters = Start(poses.front());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    information.diagonal().tail<2>().setConstant(offset_weight);
    Parameters pull = -information * parameters;
    for (const PoseAndTruth& pose : poses) {
      const Eigen::Vector3d residual = Residual(pose, FromParameters(parameters));
      Eigen::Matrix<double, 3, 6> jacobian;
      for (int i = 0; i < 6; ++i) {
        jacobian.col(i) = (Residual(pose, FromParameters(parameters + kStep * Parameters::Unit(i))) - residual) / kStep;
      }
      information += jacobian.transpose() * jacobian;
      pull -= jacobian.transpose() * residual;
    }
    parameters += information.ldlt().solve(pull);
  }
  return FromParameters(parameters);
}

FrameOffset FitBaseOffset(const std::vector<PoseAndTruth>& poses, FrameOffset map) {
  map.base_from_camera_base = Pose2();
  std::vector<double> x, y, yaw;
  for (const PoseAndTruth& pose : poses) {
    const Pose2 offset = map.Apply(pose.map_from_base).Between(pose.truth_from_base);
    x.push_back(offset.x());
    y.push_back(offset.y());
    yaw.push_back(offset.yaw());
  }
  if (!poses.empty()) {
    map.base_from_camera_base = Pose2(Percentile(x, 0.5), Percentile(y, 0.5), Percentile(yaw, 0.5));
  }
  return map;
}

}  // namespace floorloc
