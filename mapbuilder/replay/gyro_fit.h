// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/replay/fuse_frames.h"

namespace floorloc {

/// A gyro's turns about z against those of the fixes: true = scale * (measured - bias).
struct GyroFit {
  double scale = 1.0;
  double bias_rad_s = 0.0;
  double turned_rad = 0.0;  ///< by the fixes, all turns together
};

/// By pairs of localized frames in a row, at most max_pair_s apart: least squares over those that agree (RANSAC), so
/// that wrong fixes and a vehicle that is carried away do not count.
GyroFit FitGyro(const std::vector<ImuSample>& imu, const std::vector<FusedFrame>& frames, double max_pair_s);

}  // namespace floorloc
