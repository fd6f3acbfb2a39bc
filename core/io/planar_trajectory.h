// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/io/trajectory.h"

namespace floorloc {

struct PlanarTrajectoryOptions {
  /// A pose that leans further is no robot's on a floor. The steepest ramps for vehicles have some 10 degrees
  /// (ADA 405.2: 4.8), a forklift tips over at less than 30; other axes give 90 or 180.
  double max_tilt_rad = 0.5;
  double max_tilted_share = 0.1;  ///< of the rows: single ones may be glitches
  /// Height over the extent in the plane, once above min_rise_m: ramps and drifting heights stay below 0.2.
  double max_rise_ratio = 0.5;
  double min_rise_m = 0.5;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Refuses poses that are not those of a base frame on a floor (z up, roll and pitch near 0), which would be read as
/// motions that never were: quaternions with qw first, poses of a camera's optical frame, motion in z. Throws
/// InputError with the cause that explains the rows, and what to do.
void CheckPlanar(const Trajectory& trajectory, const std::filesystem::path& source,
                 const PlanarTrajectoryOptions& options = {});

}  // namespace floorloc
