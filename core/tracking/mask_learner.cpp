// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/mask_learner.h"

namespace floorloc {

void MaskLearner::Add(const ViewPose& now, const GroundImage& floor, const WheelMotion& wheels) {
  if (floor.gray.empty() || (reference_ && now.stamp_ns <= reference_->stamp_ns)) {
    return;
  }
  if (mask_.Add(floor, MotionsSinceReference(now, wheels))) {
    reference_ = now;
  }
}

void MaskLearner::Resume(const MaskEvidence& evidence) {
  mask_.Resume(evidence);
  ForgetReference();
}

// Those that are known, the best first.
std::vector<Pose2> MaskLearner::MotionsSinceReference(const ViewPose& now, const WheelMotion& wheels) const {
  std::vector<Pose2> motions;
  if (!reference_) {
    return motions;
  }
  if (reference_->map_from_base && now.map_from_base) {
    motions.push_back(reference_->map_from_base->Between(*now.map_from_base));
  }
  if (reference_->chain && reference_->chain == now.chain) {
    motions.push_back(reference_->odom_from_base.Between(now.odom_from_base));
  }
  if (const std::optional<Pose2> by_wheels = wheels(reference_->stamp_ns, now.stamp_ns)) {
    motions.push_back(*by_wheels);
  }
  return motions;
}

}  // namespace floorloc
