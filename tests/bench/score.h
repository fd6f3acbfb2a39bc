// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/io/trajectory.h"
#include "core/map/floor_map.h"

namespace floorloc {

/// What a method answered for one frame.
struct Fix {
  std::optional<Pose2> map_from_base;  ///< empty: not localized
  double total_ms = 0.0;               ///< from the encoded picture to the pose
};

/// A localized frame within these limits is a success, beyond them it is wrong.
struct Tolerance {
  double position_m = 0.010;
  double yaw_rad = 0.017453292519943295;
};

/// What all answers of a method are worth. Errors are of the localized frames, wrong ones included.
struct Score {
  int frames = 0;
  int localized = 0;
  int right = 0;
  double position_median_m = 0.0, position_p99_m = 0.0;
  double yaw_median_rad = 0.0, yaw_p99_rad = 0.0;
  double total_median_ms = 0.0;
};

/// The value below which `share` of the values lie; NaN of none.
double Percentile(std::vector<double> values, double share);

/// The rigid motion from the map's frame to the truth's, by least squares over the map's own frames, so that it does
/// not depend on the answers that are judged. Throws std::invalid_argument when fewer than two frames have a truth.
Pose2 AlignMapToTruth(const std::vector<MapFrame>& frames, const Trajectory& ground_truth);

/// fixes[i] belongs to truth[i] = truth_from_base.
Score ComputeScore(const std::vector<Fix>& fixes, const std::vector<Pose2>& truth, const Pose2& truth_from_map,
                   const Tolerance& tolerance);

}  // namespace floorloc
