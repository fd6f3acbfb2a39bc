// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/motion_pairs.h"

namespace floorloc {

/// Error of an estimated pose or motion.
struct PoseError {
  std::int64_t stamp_ns = 0;  ///< of the estimate; for a motion of its end
  double full = 0.0;          ///< Frobenius norm of E - I, E the 4x4 error matrix; dimensionless
  double translation_m = 0.0;
  double rotation_rad = 0.0;  ///< angle of the rotation error, 0 to pi
};

/// Absolute pose error: reference^-1 * estimate of every pair.
std::vector<PoseError> AbsolutePoseErrors(const std::vector<PosePair>& pairs);

/// Relative pose error: the same for motions, each between two pairs.
std::vector<PoseError> RelativePoseErrors(const std::vector<PosePair>& pairs, const std::vector<Motion>& motions);

struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;  ///< population standard deviation (divided by n)
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;  ///< sum of squared errors
  double p99 = 0.0;  ///< 99th percentile, linearly interpolated
};

/// Throws std::invalid_argument when there are no errors to summarize.
ErrorStatistics Summarize(std::vector<double> errors);

}  // namespace floorloc
