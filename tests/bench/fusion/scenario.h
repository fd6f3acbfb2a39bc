// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/fusion/pose_fuser.h"
#include "tests/bench/fusion/recording.h"

namespace floorloc {

/// Modifications of a recording before it is replayed.
struct FusionScenario {
  std::string name = {};
  bool kidnapped = false;        ///< applies to drives with kidnaps, else to those without
  double odometry_scale = 1.0;   ///< factor on distances, in addition to the recording's own errors
  double drift_rad_per_m = 0.0;  ///< likewise
  int slips = 0;                 ///< number of wheel slips, of 0.5 s and 0.1 m each
  double drop_rate = 0.0;        ///< share of the images that are not localized
  double outage_s = 0.0;         ///< duration without images, in the middle of the drive
  double wrong_rate = 0.0;       ///< share of wrong fixes, with the covariance and p_wrong of right ones
  int wrong_run = 1;             ///< number of consecutive wrong fixes with the same error, as from perceptual aliasing
  double latency_s = 0.0;        ///< mean delay between an image and its fix; uniform over 0.5 to 1.5 times this
};

/// The scenarios of the table.
std::vector<FusionScenario> AllFusionScenarios();

/// A motion and the sensor that measured it.
struct MotionMessage {
  MotionSource source = MotionSource::kWheels;
  MotionIncrement increment;
};

/// An image that was not localized.
struct LocalizationFailure {
  std::int64_t stamp_ns = 0;
};

struct FusionMessage {
  std::int64_t arrival_ns = 0;
  std::variant<MotionMessage, ImuReading, PoseFix, LocalizationFailure> content;
};

/// The recording's messages in order of arrival, modified by the scenario. Equal seeds give equal messages.
std::vector<FusionMessage> MakeMessages(const FusionRecording& recording, const FusionScenario& scenario,
                                        std::uint64_t seed);

}  // namespace floorloc
