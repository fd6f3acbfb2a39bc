// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/diagnosis/diagnosis.h"
#include "mapbuilder/replay/fuse_frames.h"

namespace floorloc {

/// Judges a recorded drive that was replayed in a map, as a server judges a vehicle that drives: one finding or more
/// for each part that the recording has. max_stamp_lag_s is not used: a recording's stamps overlap, or its clocks
/// differ, and then it was replayed without odometry (WithoutForeignClocks).
std::vector<Finding> CheckDrive(const Survey& drive, const FusedDrive& fused, const DiagnosisOptions& options = {});

/// The drive without the odometry and the IMU whose stamps do not overlap those of the images.
Survey WithoutForeignClocks(Survey drive);

}  // namespace floorloc
