// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/evaluation/alignment.h"
#include "core/evaluation/association.h"
#include "core/evaluation/motion_pairs.h"
#include "core/evaluation/trajectory_error.h"

namespace floorloc {

enum class ErrorMetric {
  kAbsolute,  ///< APE: of the poses
  kRelative,  ///< RPE: of the motions between them
};

struct EvaluationOptions {
  ErrorMetric metric = ErrorMetric::kAbsolute;
  AlignmentMode align = AlignmentMode::kNone;
  double max_diff_s = 0.01;           ///< largest time difference of a pair
  double time_offset_s = 0.0;         ///< added to the estimate's stamps first
  bool planar = false;                ///< compare x, y and yaw only
  MotionOptions motions;              ///< of the relative error
  bool motions_of_reference = false;  ///< measure their lengths along the reference instead of the estimate

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

struct TrajectoryEvaluation {
  std::size_t reference_poses = 0;
  std::size_t estimated_poses = 0;
  Similarity3 alignment;
  std::vector<PosePair> pairs;        ///< aligned
  std::vector<std::size_t> error_at;  ///< index of each error's pair; for a motion that of its end
  std::vector<PoseError> errors;
  ErrorStatistics full;         ///< dimensionless
  ErrorStatistics translation;  ///< metres
  ErrorStatistics rotation;     ///< radians
};

/// Compares an estimated trajectory with the true one by the definitions of the trajectory tool evo. Throws
/// std::invalid_argument when they have too little in common; its message lacks the subject, which the caller prepends.
TrajectoryEvaluation EvaluateTrajectory(const Trajectory& reference, const Trajectory& estimate,
                                        const EvaluationOptions& options);

}  // namespace floorloc
