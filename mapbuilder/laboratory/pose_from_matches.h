// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/descriptor_index.h"
#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// How a pose is computed from the matches that are left.
enum class PoseFit {
  kLeastSquares,  ///< rigid motion with the smallest squared residuals
  kWeightedMean,  ///< the thesis's: means of places and angle differences, weighted by 1 / descriptor distance
};

struct PoseFromMatchesOptions {
  double max_ratio = 0.75;         ///< of the nearest to the second nearest distance
  double inlier_radius_m = 0.003;  ///< of RANSAC, and of what counts as an inlier of a pose
  double max_scale_error = 0.05;   ///< RANSAC's similarities that are off by more are no answer: the scale is known
  PoseFit fit = PoseFit::kLeastSquares;
};

/// What became of one frame's matches.
struct MatchedPose {
  std::vector<Match> matches;          ///< those that passed the filter
  int inliers = 0;                     ///< of them, those that agree with the pose
  std::optional<Pose2> map_from_base;  ///< empty with fewer than two matches, or when RANSAC finds no pose
};

/// neighbours: the nearest of each frame keypoint, with the second nearest distance.
MatchedPose ComputePose(const std::vector<Match>& neighbours, const Features& frame, const Features& map,
                        MatchFilter filter, const PoseFromMatchesOptions& options);

}  // namespace floorloc
