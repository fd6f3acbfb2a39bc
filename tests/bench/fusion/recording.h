// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/fusion/measurements.h"
#include "core/io/trajectory.h"
#include "core/localization/localizer.h"

namespace floorloc {

/// One image and its measurements.
struct RecordedImage {
  std::int64_t stamp_ns = 0;
  std::optional<PoseFix> fix;             ///< by global search; empty: not localized
  std::optional<MotionIncrement> motion;  ///< visual, since the previous image; empty: unknown
};

/// Measurements of a robot on a drive, and the truth.
struct FusionRecording {
  std::string name;
  Trajectory odometry;                ///< odom_from_base
  std::vector<ImuReading> imu;        ///< empty without an IMU
  std::vector<RecordedImage> images;  ///< in order of time, in the map's frame
  Trajectory truth;                   ///< map_from_base at the odometry's times, in the map's frame
  std::vector<std::int64_t> kidnaps_ns;
};

/// Reads a simulated drive and localizes its frames. The truth is aligned to the map's frame by a robust fit to the
/// fixes. Throws InputError.
FusionRecording ReadFusionRecording(const Localizer& localizer, const std::filesystem::path& drive);

}  // namespace floorloc
