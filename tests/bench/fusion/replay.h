// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/fusion/pose_fuser.h"
#include "tests/bench/fusion/scenario.h"

namespace floorloc {

/// A fusion method with its name in the table.
struct FusionVariant {
  std::string name;
  FusionMethod method = FusionMethod::kEkf;
  bool uses_visual_motion = false;
  bool uses_imu = false;
  PoseFilterOptions options = {};
  bool uses_wheels = true;
};

std::vector<FusionVariant> AllFusionVariants();

/// Passes a message to the fuser when the variant uses its sensor.
void DeliverMessage(const FusionMessage& message, const FusionVariant& variant, PoseFuser* fuser);

/// The fuser's estimate after a wheel increment, and the truth at that time.
struct FusionSample {
  std::int64_t stamp_ns = 0;
  std::optional<FusedPose> estimate;
  Pose2 truth;
};

/// Passes the messages to a new fuser in order. Returns one sample per wheel increment; `truth` has their times.
std::vector<FusionSample> ReplayMessages(const std::vector<FusionMessage>& messages, const Trajectory& truth,
                                         const FusionVariant& variant);

}  // namespace floorloc
