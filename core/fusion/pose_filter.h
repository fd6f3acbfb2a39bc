// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/fusion/doubt.h"
#include "core/fusion/gyro_monitor.h"
#include "core/fusion/kidnap_detector.h"
#include "core/fusion/odometry_monitor.h"
#include "core/fusion/pose_fuser.h"
#include "core/fusion/state_history.h"

namespace floorloc {

/// Extended Kalman filter on SE(2) with its error state in the tangent space (Sola, Deray & Atchuthan 2018): pose,
/// velocity, biases of the IMU and of the wheels. Fixes are applied at their own time: the states of the last seconds
/// are remembered, and the filter is rerun from the time of a late message. Bounded memory.
class PoseFilter : public PoseFuser {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit PoseFilter(const PoseFilterOptions& options = {});

  MessageOutcome AddIncrement(MotionSource source, const MotionIncrement& increment) override;
  MessageOutcome AddImu(const ImuReading& reading) override;
  FixOutcome AddFix(const PoseFix& fix) override;
  void AddUnlocalizedFrame(std::int64_t stamp_ns) override;
  void SetPose(const PoseFix& pose) override;
  std::optional<FusedPose> Estimate() const override;
  std::optional<FusedPose> EstimateAt(std::int64_t stamp_ns) const override;
  std::optional<Pose2> MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const override {
    return history_.MotionBetween(from_ns, to_ns);
  }
  std::optional<LearntOdometry> Learnt() const override;
  void Resume(const LearntOdometry& learnt) override;

  /// The full state at the newest message; empty before there is a pose.
  std::optional<FilterState> State() const;

 private:
  template <typename Track, typename Message>
  MessageOutcome AddTo(Track* track, const Message& message, std::int64_t begin_ns, std::int64_t end_ns);
  void RestartAt(std::int64_t stamp_ns);
  void Advance(std::int64_t stamp_ns);
  bool IsLost(const FilterState& state) const;
  MotionIncrement WithRightStamp(const MotionIncrement& increment) const;
  bool JudgeOdometry(const PoseFix& fix);
  void JudgeGyro(const PoseFix& fix);
  void OutvoteVision(const PoseFix& fix, FilterState* predicted, FixOutcome* outcome);
  FixOutcome AnchorWithFreshSensors(const PoseFix& fix, const FilterState& imu);
  FixOutcome Anchor(const PoseFix& fix);
  OdometryTrust TrustIn(const FilterState& state) const;
  FixOutcome Accept(const PoseFix& fix, const FixOutcome& outcome);
  FixOutcome Reject(const PoseFix& fix, FixOutcome outcome);
  FusedPose ToFusedPose(const FilterState& state) const;

  const PoseFilterOptions options_;
  StateHistory history_;
  KidnapDetector kidnap_;
  OdometryMonitor monitor_;
  GyroMonitor gyro_monitor_;
  Doubt doubt_;
  std::optional<std::int64_t> last_fix_ns_;  // accepted
  bool has_pose_ = false;
  bool last_frame_agreed_ = false;
  int messages_before_history_ = 0;
};

}  // namespace floorloc
