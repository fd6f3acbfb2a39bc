// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/fusion/jump_filter.h"
#include "core/fusion/pose_fuser.h"

namespace floorloc {

/// Baselines without covariance propagation: see FusionMethod. Messages are applied in the order of arrival; increments
/// that end before the newest message are dropped as too old. Every pose is reported as localized, with the covariance
/// of the last fix.
class SimpleFuser : public PoseFuser {
 public:
  /// Any method but kEkf.
  SimpleFuser(FusionMethod method, const FixGates& gates);

  MessageOutcome AddIncrement(MotionSource source, const MotionIncrement& increment) override;
  MessageOutcome AddImu(const ImuReading& reading) override;
  FixOutcome AddFix(const PoseFix& fix) override;
  void AddUnlocalizedFrame(std::int64_t stamp_ns) override;
  void SetPose(const PoseFix& pose) override;
  std::optional<FusedPose> Estimate() const override;
  std::optional<FusedPose> EstimateAt(std::int64_t stamp_ns) const override;
  std::optional<Pose2> MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const override;

 private:
  bool ShouldAccept(const PoseFix& fix);
  void ResetPose(const PoseFix& fix);

  const FusionMethod method_;
  JumpFilter jump_filter_;
  bool has_wheels_ = false;
  std::optional<std::int64_t> newest_ns_;
  std::optional<PoseFix> last_fix_;
  Pose2 map_from_base_;
  Pose2 odom_from_base_;
  SinceFix since_fix_;
};

}  // namespace floorloc
