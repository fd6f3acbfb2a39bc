// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/odometry/learned_mask.h"

namespace floorloc {

/// Where a view was taken, as far as it is known.
struct ViewPose {
  std::int64_t stamp_ns = 0;
  std::optional<Pose2> map_from_base = {};  ///< by an accepted fix
  Pose2 odom_from_base = {};                ///< by visual odometry
  std::optional<int> chain = {};            ///< of visual odometry; empty: it was lost
};

/// Shows a vehicle's views to its LearnedMask, with the motion between them by fixes, visual odometry and wheels.
class MaskLearner {
 public:
  /// Motion from one time to another by the wheels, to_from; empty: not covered.
  using WheelMotion = std::function<std::optional<Pose2>(std::int64_t from_ns, std::int64_t to_ns)>;

  explicit MaskLearner(const LearnedMaskOptions& options) : mask_(options) {}

  /// floor: FrameObservation::floor of the view; may be empty.
  void Add(const ViewPose& now, const GroundImage& floor, const WheelMotion& wheels);
  const LearnedMaskState& State() const { return mask_.State(); }
  MaskEvidence Learnt() const { return mask_.Learnt(); }
  void Resume(const MaskEvidence& evidence);
  /// After a clock jump: motions since the last view are unknown.
  void ForgetReference() { reference_.reset(); }

 private:
  std::vector<Pose2> MotionsSinceReference(const ViewPose& now, const WheelMotion& wheels) const;

  LearnedMask mask_;
  std::optional<ViewPose> reference_;
};

}  // namespace floorloc
