// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/velocity_estimator.h"

#include <cmath>
#include <numbers>

namespace floorloc {

void VelocityEstimator::Add(const PoseReport& report) {
  if (!report.pose) {
    Reset();
    return;
  }
  const ReportedPose& pose = *report.pose;
  if (!poses_.empty()) {
    const double step_s = pose.stamp_s - poses_.back().stamp_s;
    if (step_s == 0.0 && report.epoch == epoch_) {
      return;  // the same message once more
    }
    if (report.epoch != epoch_ || step_s < 0.0 || step_s > options_.max_gap_s) {
      Reset();
    }
  }
  epoch_ = report.epoch;
  poses_.push_back(pose);
  while (poses_.size() > 2 && pose.stamp_s - poses_[1].stamp_s >= options_.span_s) {
    poses_.pop_front();
  }
}

std::optional<Velocity> VelocityEstimator::velocity() const {
  if (poses_.size() < 2) {
    return std::nullopt;
  }
  const ReportedPose& from = poses_.front();
  const ReportedPose& to = poses_.back();
  const double span_s = to.stamp_s - from.stamp_s;
  const double turn = std::remainder(to.yaw - from.yaw, 2.0 * std::numbers::pi);
  const double heading = from.yaw + 0.5 * turn;  // of the chord of an arc
  const double vx = (to.x - from.x) / span_s;
  const double vy = (to.y - from.y) / span_s;
  return Velocity{std::cos(heading) * vx + std::sin(heading) * vy, -std::sin(heading) * vx + std::cos(heading) * vy,
                  turn / span_s};
}

}  // namespace floorloc
