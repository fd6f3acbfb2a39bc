// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Result of a method for one frame.
struct Fix {
  std::optional<Pose2> map_from_base;  ///< empty: not localized
  double total_ms = 0.0;
};

/// A localized frame is a success within these limits, wrong beyond them.
struct Tolerance {
  double position_m = 0.010;
  double yaw_rad = 0.017453292519943295;
};

/// Root mean squares along the axes of the truth's frame, and of the heading.
struct Deviation {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  double position_m() const;
};

/// Accuracy of all results of a method. Errors are over the localized frames, including wrong ones; NaN when there are
/// none.
struct Score {
  int frames = 0;
  int localized = 0;
  int right = 0;
  double position_mean_m = 0.0, position_median_m = 0.0, position_p99_m = 0.0;
  double yaw_mean_rad = 0.0, yaw_median_rad = 0.0, yaw_p99_rad = 0.0;
  Deviation accuracy;   ///< errors relative to zero
  Deviation precision;  ///< errors relative to their mean: the repeatability of the poses at standstill
  double total_median_ms = 0.0;
};

/// Quantile of the values for `share`; NaN without values.
double Percentile(std::vector<double> values, double share);
/// NaN without values.
double Mean(const std::vector<double>& values);

/// fixes[i] belongs to truth[i] = truth_from_base.
Score ComputeScore(const std::vector<Fix>& fixes, const std::vector<Pose2>& truth, const Pose2& truth_from_map,
                   const Tolerance& tolerance);

}  // namespace floorloc
