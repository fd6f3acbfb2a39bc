// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/localization/candidate_search.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localization_result.h"
#include "core/registration/registration.h"

namespace floorloc {

/// A keypoint of a frame and the map point that it matches under a pose.
struct PointMatch {
  Eigen::Vector2d base_m = Eigen::Vector2d::Zero();  ///< base frame
  Eigen::Vector2d map_m = Eigen::Vector2d::Zero();   ///< map frame
  bool inlier = false;                               ///< within RegistrationOptions::inlier_radius_m of each other
};

/// A pose that a frame may have, and what its keypoints match there.
struct CompetingPose {
  Pose2 map_from_base;
  std::vector<PointMatch> matches;  ///< of all keypoints that match a map point near where the pose predicts them
  int inliers = 0;
  double log10_nfa = 0.0;  ///< PoseCandidate::log10_nfa
};

/// Where competing poses are sought.
struct CompetingPoseSearch {
  const CandidateSearch& search;
  const RegistrationOptions& options;  ///< scaled to the map's resolution
  Pose2 map_from_origin;               ///< of the search's keypoints
  std::size_t max_poses = 0;
};

/// As Localizer::Compete.
std::vector<CompetingPose> FindCompetingPoses(const CompetingPoseSearch& in, const FrameObservation& frame,
                                              const LocalizationResult& result);

}  // namespace floorloc
