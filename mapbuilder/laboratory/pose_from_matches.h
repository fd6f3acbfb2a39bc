// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/descriptor_index.h"
#include "mapbuilder/laboratory/combination.h"

namespace floorloc {

/// Estimation of the pose from the filtered matches.
enum class PoseFit {
  kLeastSquares,  ///< rigid motion with the smallest squared residuals
  kWeightedMean,  ///< as in the thesis: mean positions and angle differences, weighted by 1 / descriptor distance
};

struct PoseFromMatchesOptions {
  double max_ratio = 0.75;         ///< maximum ratio of nearest to second-nearest distance
  double inlier_radius_m = 0.003;  ///< for RANSAC and for counting a pose's inliers
  double max_scale_error = 0.05;   ///< rejects RANSAC similarities whose scale deviates more from 1
  PoseFit fit = PoseFit::kLeastSquares;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Result for one frame's matches.
struct MatchedPose {
  std::vector<Match> matches;          ///< after the filter
  int inliers = 0;                     ///< of these, the ones consistent with the pose
  std::optional<Pose2> map_from_base;  ///< empty with fewer than two matches, or when RANSAC finds no pose
};

/// neighbours: nearest neighbour of each frame keypoint, with the second-nearest distance.
MatchedPose ComputePose(const std::vector<Match>& neighbours, const Features& frame, const Features& map,
                        MatchFilter filter, const PoseFromMatchesOptions& options);

}  // namespace floorloc
