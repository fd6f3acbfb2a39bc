// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace floorloc {
namespace {

// x_in_target = rotation * x_in_source + translation.
struct RigidMotion {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation_m;
};

RigidMotion MotionOf(const StampedPose3& pose) { return {pose.rotation, pose.translation_m}; }

// from^-1 * to.
RigidMotion Between(const RigidMotion& from, const RigidMotion& to) {
  const Eigen::Quaterniond inverse = from.rotation.conjugate();
  return {(inverse * to.rotation).normalized(), inverse * (to.translation_m - from.translation_m)};
}

PoseError ErrorOf(const RigidMotion& reference, const RigidMotion& estimate, std::int64_t stamp_ns) {
  const RigidMotion difference = Between(reference, estimate);
  const Eigen::Matrix3d rotation_part = difference.rotation.toRotationMatrix() - Eigen::Matrix3d::Identity();
  PoseError error;
  error.stamp_ns = stamp_ns;
  error.full = std::sqrt(rotation_part.squaredNorm() + difference.translation_m.squaredNorm());
  error.translation_m = difference.translation_m.norm();
  error.rotation_rad = Eigen::Quaterniond::Identity().angularDistance(difference.rotation);
  return error;
}

// q in [0, 1]; the errors are sorted.
double Quantile(const std::vector<double>& errors, double q) {
  const double position = q * static_cast<double>(errors.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, errors.size() - 1);
  return std::lerp(errors[below], errors[above], position - static_cast<double>(below));
}

}  // namespace

std::vector<PoseError> AbsolutePoseErrors(const std::vector<PosePair>& pairs) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : pairs) {
    errors.push_back(ErrorOf(MotionOf(pair.reference), MotionOf(pair.estimate), pair.estimate.stamp_ns));
  }
  return errors;
}

std::vector<PoseError> RelativePoseErrors(const std::vector<PosePair>& pairs, const std::vector<Motion>& motions) {
  std::vector<PoseError> errors;
  for (const Motion& motion : motions) {
    const PosePair& from = pairs[motion.from];
    const PosePair& to = pairs[motion.to];
    errors.push_back(ErrorOf(Between(MotionOf(from.reference), MotionOf(to.reference)),
                             Between(MotionOf(from.estimate), MotionOf(to.estimate)), to.estimate.stamp_ns));
  }
  return errors;
}

ErrorStatistics Summarize(std::vector<double> errors) {
  if (errors.empty()) {
    throw std::invalid_argument("there are no errors to summarize");
  }
  std::sort(errors.begin(), errors.end());
  const double n = static_cast<double>(errors.size());
  ErrorStatistics s;
  s.min = errors.front();
  s.max = errors.back();
  s.median = Quantile(errors, 0.5);
  s.p99 = Quantile(errors, 0.99);
  s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  s.sse = std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0);
  s.rmse = std::sqrt(s.sse / n);
  double squared_deviations = 0.0;
  for (const double error : errors) {
    squared_deviations += (error - s.mean) * (error - s.mean);
  }
  s.std = std::sqrt(squared_deviations / n);
  return s;
}

}  // namespace floorloc
