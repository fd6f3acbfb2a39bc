// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/fusion/pose_fuser.h"
#include "tests/bench/fusion/recording.h"

namespace floorloc {

/// What is done to a recording before it is replayed.
struct FusionScenario {
  std::string name = {};
  bool kidnapped = false;        ///< of drives with kidnaps, else of those without
  double odometry_scale = 1.0;   ///< factor on distances, besides the recording's own errors
  double drift_rad_per_m = 0.0;  ///< likewise
  int slips = 0;                 ///< the wheels spin that often for half a second, 0.1 m in all each time
  double drop_rate = 0.0;        ///< share of the images that are not localized
  double outage_s = 0.0;         ///< the camera sees nothing for so long, in the middle of the drive
  double wrong_rate = 0.0;       ///< share of the fixes that is wrong, as sure of themselves as the right ones
  int wrong_run = 1;             ///< so many fixes in a row are off by the same motion, as by perceptual aliasing
  double latency_s = 0.0;        ///< between an image and its fix; from half to one and a half times as long
};

/// The scenarios of the table.
std::vector<FusionScenario> AllFusionScenarios();

/// A motion, and the sensor that measured it.
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

/// The recording's messages as they arrive, changed as the scenario has it. The same seed gives the same messages.
std::vector<FusionMessage> MakeMessages(const FusionRecording& recording, const FusionScenario& scenario,
                                        std::uint64_t seed);

}  // namespace floorloc
