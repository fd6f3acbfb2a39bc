// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/odometry/planar_odometry.h"

namespace floorloc {

/// A method's result on one frame of a drive.
struct OdometryStep {
  bool lost = false;
  Pose2 odom_from_base;
  int chain = 0;  ///< poses with the same number are connected by measured motions
  std::optional<VisualMotion> motion;
  bool new_keyframe = false;
  double extract_ms = 0.0;
  double track_ms = 0.0;
};

/// Sums over drives.
struct DriftTally {
  std::vector<double> extract_ms, track_ms;  ///< per frame
  int frames = 0;
  int lost = 0;
  int wrong = 0;                                ///< motions with an error above 20 mm or 2 degrees
  std::vector<double> motion_m, motion_rad;     ///< errors of single motions
  std::vector<double> drift_share;              ///< error over 0.5 m of path, divided by the path length
  std::vector<double> drift_rad_per_m;          ///< the same for the heading
  std::vector<double> nees_alone, nees_summed;  ///< of single motions; of the motion since the last keyframe
};

/// Adds the steps of a drive with the given truth. The first frame is not counted.
void AddDrift(const std::vector<OdometryStep>& steps, const std::vector<Pose2>& truth, DriftTally* tally);

}  // namespace floorloc
