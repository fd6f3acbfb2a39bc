// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace floorloc {

/// From one fix to the next.
struct GyroTurn {
  double seconds = 0.0;
  double by_fixes_rad = 0.0;
  double by_gyro_rad = 0.0;
};

/// A gyro's turns about z against those of the fixes: true = scale * (measured - bias).
struct GyroFit {
  double scale = 1.0;
  double bias_rad_s = 0.0;
  double turned_rad = 0.0;  ///< by the fixes, all turns together
};

/// Least squares over the turns that agree (RANSAC), so that wrong fixes and a vehicle that is carried away do not
/// count.
GyroFit FitGyro(const std::vector<GyroTurn>& turns);

}  // namespace floorloc
