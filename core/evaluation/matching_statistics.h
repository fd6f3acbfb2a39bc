// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Share of the query's keypoints with a target keypoint within radius_m of their position under the true pose:
/// repeatability of a detector (Schmid, Mohr & Bauckhage 2000). 0 without keypoints. radius_m > 0.
double Repeatability(const std::vector<Keypoint>& query, const std::vector<Keypoint>& target,
                     const Pose2& target_from_query, double radius_m);

/// For each match, whether its keypoints are within radius_m of each other under the true pose.
std::vector<bool> FindCorrectMatches(const std::vector<Match>& matches, const std::vector<Keypoint>& query,
                                     const std::vector<Keypoint>& target, const Pose2& target_from_query,
                                     double radius_m);

/// Right matches per query keypoint: quality of detector and descriptor together (Mikolajczyk & Schmid 2005).
/// 0 without keypoints.
double MatchingScore(const std::vector<bool>& right_matches, std::size_t query_keypoints);

}  // namespace floorloc
