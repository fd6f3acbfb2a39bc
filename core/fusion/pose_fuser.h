// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/fusion/filter_options.h"
#include "core/fusion/fused_pose.h"
#include "core/fusion/learnt_odometry.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// How increments and fixes are fused to one pose.
enum class FusionMethod {
  kEkf,         ///< PoseFilter
  kIncrements,  ///< the first fix, propagated by increments alone
  kFixes,       ///< the last fix alone
  kReplace,     ///< increments are added, a fix replaces the pose, as in the thesis (3.3.8)
  kJumpFilter,  ///< the same, but fixes that jump by more than the distance and angle gates are dropped
};
/// "ekf", "increments", "fixes", "replace", "jump_filter"
const char* ToString(FusionMethod method);
/// Throws std::invalid_argument that lists the known names.
FusionMethod ParseFusionMethod(const std::string& name);

enum class MotionSource { kWheels, kVision };

/// Estimates the pose of one vehicle. Not thread-safe.
class PoseFuser {
 public:
  virtual ~PoseFuser() = default;

  virtual MessageOutcome AddIncrement(MotionSource source, const MotionIncrement& increment) = 0;
  virtual MessageOutcome AddImu(const ImuReading& reading) = 0;
  virtual FixOutcome AddFix(const PoseFix& fix) = 0;
  /// Reports that the image of this time was not localized.
  virtual void AddUnlocalizedFrame(std::int64_t stamp_ns) = 0;
  /// Sets the pose by hand; the next fixes are gated against it.
  virtual void SetPose(const PoseFix& pose) = 0;

  /// At the time of the newest message; empty before there was a fix or a pose by hand.
  virtual std::optional<FusedPose> Estimate() const = 0;
  /// At a time within the history or after the newest message; empty for earlier times.
  virtual std::optional<FusedPose> EstimateAt(std::int64_t stamp_ns) const = 0;
  /// What was learnt of wheels that agree with the fixes; empty: nothing, or by a method that does not learn.
  virtual std::optional<LearntOdometry> Learnt() const { return std::nullopt; }
  /// Starts with what was learnt before; to be called before the first message.
  virtual void Resume(const LearntOdometry& /*learnt*/) {}

  /// Motion of the base between two times without the fixes in between; empty for times before the history.
  virtual std::optional<Pose2> MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const = 0;
};

/// Throws std::invalid_argument when the options do not pass Check().
std::unique_ptr<PoseFuser> MakePoseFuser(FusionMethod method, const PoseFilterOptions& options);

}  // namespace floorloc
