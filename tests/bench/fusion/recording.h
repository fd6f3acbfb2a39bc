// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/fusion/measurements.h"
#include "core/io/trajectory.h"

namespace floorloc {

/// What a robot sent on a drive, and the truth.
struct FusionRecording {
  std::string name;
  Trajectory odometry;                  ///< odom_from_base
  std::vector<ImuReading> imu;          ///< empty without one
  std::vector<PoseFix> fixes;           ///< in the order of time, in the map's frame
  std::vector<std::int64_t> misses_ns;  ///< pictures that gave no fix
  Trajectory truth;                     ///< map_from_base at the odometry's times, in the map's frame
  std::vector<std::int64_t> kidnaps_ns;
};

/// Reads a simulated drive and what `floorloc-mapbuilder localize --results` said of its frames. The truth is moved
/// into the map's frame by the fixes themselves, robustly. Throws InputError.
FusionRecording ReadFusionRecording(const std::filesystem::path& drive, const std::filesystem::path& results);

}  // namespace floorloc
