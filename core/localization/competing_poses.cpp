// SPDX-License-Identifier: Apache-2.0
#include "core/localization/competing_poses.h"

#include <algorithm>
#include <utility>

namespace floorloc {
namespace {

CompetingPose Compete(const VerifiedPose& verified, const Pose2& map_from_origin) {
  const PoseCandidate& candidate = verified.candidate;
  CompetingPose pose{map_from_origin * candidate.target_from_source,
                     {},
                     static_cast<int>(candidate.inliers.size()),
                     candidate.log10_nfa};
  pose.matches.reserve(verified.matches.size());
  for (const OrientedMatch& match : verified.matches) {
    pose.matches.push_back({match.source_m, map_from_origin * match.target_m, false});
  }
  for (const int i : candidate.inliers) {
    pose.matches[static_cast<std::size_t>(i)].inlier = true;
  }
  return pose;
}

}  // namespace

std::vector<CompetingPose> FindCompetingPoses(const CandidateSearch& search, const FrameObservation& frame,
                                              const LocalizationResult& result, std::size_t max_poses,
                                              const Pose2& map_from_origin, const RegistrationOptions& options) {
  std::vector<CompetingPose> poses;
  const auto is_known = [&](const Pose2& map_from_base) {
    return std::any_of(poses.begin(), poses.end(), [&](const CompetingPose& known) {
      return SamePose(known.map_from_base, map_from_base, options);
    });
  };
  const auto add = [&](const Pose2& map_from_base) {
    if (poses.size() < max_poses && !is_known(map_from_base)) {
      CompetingPose pose = Compete(search.Verify(frame, map_from_origin.Inverse() * map_from_base), map_from_origin);
      if (!is_known(pose.map_from_base)) {
        poses.push_back(std::move(pose));
      }
    }
  };
  if (result.inliers > 0 && max_poses > 0) {
    add(result.map_from_base);
    poses.front().map_from_base = result.map_from_base;  // by the pixels, too, where they were compared
  }
  for (const PoseHypothesis& other : result.alternatives) {
    add(other.target_from_source);
  }
  const std::size_t given = poses.size();
  const FrameMatches anywhere = search.FindMatches(frame, SearchScope());
  for (const PoseCandidate& candidate : FindPoseCandidates(anywhere.oriented, options)) {
    add(map_from_origin * candidate.target_from_source);
  }
  std::stable_sort(poses.begin() + static_cast<std::ptrdiff_t>(given), poses.end(),
                   [](const CompetingPose& a, const CompetingPose& b) { return a.inliers > b.inliers; });
  return poses;
}

}  // namespace floorloc
