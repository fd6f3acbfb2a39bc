// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/fusion/replay.h"

namespace floorloc {

/// What a vehicle was told while its odometry was faulty: answers to its images, and the pose between them.
struct FaultScore {
  std::size_t frames = 0;    ///< answers to images
  std::size_t good = 0;      ///< of these "localized", and within kGoodM
  std::size_t tracking = 0;  ///< of these "tracking_odometry"
  std::size_t lost = 0;
  int longest_wrong_run = 0;    ///< successive answers that claim a pose (not "lost") and are beyond kClaimSigmas
  std::vector<double> nees;     ///< of the answers that claim a pose
  std::vector<double> between;  ///< errors at the times of the odometry, m

  void Add(const FaultScore& other);
};

inline constexpr double kGoodM = 0.010;
inline constexpr double kClaimSigmas = 5.0;
/// After the onset of a fault, until answers are judged.
inline constexpr double kFaultSettleS = 5.0;

/// An answer to an image.
struct FrameAnswer {
  std::int64_t stamp_ns = 0;
  std::optional<FusedPose> estimate;
  Pose2 truth;
};

/// Replays a recording with faulty messages and scores what comes after the onset and kFaultSettleS.
FaultScore ReplayFault(const FusionRecording& recording, const std::vector<FusionMessage>& messages,
                       const FusionVariant& variant);

/// Scores answers in their order.
void ScoreAnswers(const std::vector<FrameAnswer>& answers, FaultScore* score);

}  // namespace floorloc
