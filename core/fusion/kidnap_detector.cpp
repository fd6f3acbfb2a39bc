// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/kidnap_detector.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

constexpr std::size_t kMaxContradictions = 32;

}  // namespace

bool KidnapDetector::Agree(const PoseFix& earlier, const PoseFix& later, const MotionBetween& motion_between) const {
  const MotionEstimate moved = motion_between(earlier.stamp_ns, later.stamp_ns);
  const Pose2 difference = (earlier.map_from_base * moved.motion).Between(later.map_from_base);
  return difference.translation().norm() <= options_.max_distance_m + options_.sigmas * moved.sigma_m &&
         std::abs(difference.yaw()) <= options_.max_angle_rad + options_.sigmas * moved.sigma_rad;
}

int KidnapDetector::AddContradiction(const PoseFix& fix, const MotionBetween& motion_between) {
  const auto max_age_ns = static_cast<std::int64_t>(1e9 * options_.max_age_s);
  std::erase_if(contradictions_, [&](const PoseFix& c) { return fix.stamp_ns - c.stamp_ns > max_age_ns; });
  const auto others = std::count_if(contradictions_.begin(), contradictions_.end(), [&](const PoseFix& c) {
    return c.stamp_ns < fix.stamp_ns && Agree(c, fix, motion_between);
  });
  contradictions_.push_back(fix);
  if (contradictions_.size() > kMaxContradictions) {
    contradictions_.pop_front();
  }
  agreeing_ = static_cast<int>(others) + 1;
  return agreeing_;
}

void KidnapDetector::Clear() {
  contradictions_.clear();
  agreeing_ = 0;
}

}  // namespace floorloc
