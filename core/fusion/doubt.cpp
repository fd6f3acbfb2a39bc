// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/doubt.h"

#include <algorithm>

#include "core/fusion/odometry_monitor.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxRejected = 16;
constexpr double kSuspicionDecay = 0.8;  // per fix: the second refusal of five raises it above the threshold
constexpr double kMaxGrowth = 3.0;       // of the error while nothing new is known

}  // namespace

void Doubt::Note(const PoseFix& fix, const FixOutcome& outcome) {
  if (outcome.reason == FixRejection::kWrongFixRisk) {
    return;
  }
  suspicion_ *= kSuspicionDecay;
  restlessness_ *= kSuspicionDecay;
  if (outcome.accepted) {
    Settle(fix);
    return;
  }
  suspicion_ += outcome.reason == FixRejection::kMahalanobis ? 1.0 : 0.0;
  restlessness_ += 1.0;
  distance_m_ = outcome.distance_m;
  angle_rad_ = outcome.angle_rad;
  rejected_.push_back(fix);
  if (rejected_.size() > kMaxRejected) {
    rejected_.pop_front();
  }
}

void Doubt::Settle(const std::optional<PoseFix>& fix) {
  accepted_ = fix;
  rejected_.clear();
  distance_m_ = angle_rad_ = 0.0;
}

bool Doubt::IsReachable() const {
  return accepted_ && !rejected_.empty() && IsPossibleMotion(*accepted_, rejected_.back(), options_);
}

std::optional<PoseFix> Doubt::Previous() const {
  if (rejected_.empty()) {
    return std::nullopt;
  }
  const std::optional<PoseFix> before =
      rejected_.size() > 1 ? std::optional(rejected_[rejected_.size() - 2]) : accepted_;
  return before && before->stamp_ns < rejected_.back().stamp_ns && IsPossibleMotion(*before, rejected_.back(), options_)
             ? before
             : std::nullopt;
}

Eigen::Matrix3d Doubt::CovarianceAt(std::int64_t stamp_ns) const {
  if (rejected_.empty()) {
    return Eigen::Matrix3d::Zero();
  }
  double growth = 1.0;
  if (accepted_ && rejected_.back().stamp_ns > accepted_->stamp_ns) {
    growth = std::clamp(static_cast<double>(stamp_ns - accepted_->stamp_ns) /
                            static_cast<double>(rejected_.back().stamp_ns - accepted_->stamp_ns),
                        0.0, kMaxGrowth);
  }
  const Eigen::Vector3d sigma = growth * Eigen::Vector3d(distance_m_, distance_m_, angle_rad_);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace floorloc
