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

// Verifies poses, and keeps each once.
class Contest {
 public:
  Contest(const CompetingPoseSearch& in, const FrameObservation& frame) : in_(in), frame_(frame) {}

  void Add(const Pose2& map_from_base) {
    if (poses_.size() >= in_.max_poses || Knows(map_from_base)) {
      return;
    }
    CompetingPose pose =
        Compete(in_.search.Verify(frame_, in_.map_from_origin.Inverse() * map_from_base), in_.map_from_origin);
    if (!Knows(pose.map_from_base)) {
      poses_.push_back(std::move(pose));
    }
  }
  std::vector<CompetingPose>& poses() { return poses_; }

 private:
  bool Knows(const Pose2& map_from_base) const {
    return std::any_of(poses_.begin(), poses_.end(), [&](const CompetingPose& known) {
      return SamePose(known.map_from_base, map_from_base, in_.options);
    });
  }

  const CompetingPoseSearch& in_;
  const FrameObservation& frame_;
  std::vector<CompetingPose> poses_;
};

}  // namespace

std::vector<CompetingPose> FindCompetingPoses(const CompetingPoseSearch& in, const FrameObservation& frame,
                                              const LocalizationResult& result) {
  Contest contest(in, frame);
  std::vector<CompetingPose>& poses = contest.poses();
  if (result.inliers > 0 && in.max_poses > 0) {
    contest.Add(result.map_from_base);
    poses.front().map_from_base = result.map_from_base;  // by the pixels, too, where they were compared
  }
  for (const PoseHypothesis& other : result.alternatives) {
    contest.Add(other.target_from_source);
  }
  const auto given = static_cast<std::ptrdiff_t>(poses.size());
  const FrameMatches anywhere = in.search.FindMatches(frame, SearchScope());
  for (const PoseCandidate& candidate : FindPoseCandidates(anywhere.oriented, in.options)) {
    contest.Add(in.map_from_origin * candidate.target_from_source);
  }
  std::stable_sort(poses.begin() + given, poses.end(),
                   [](const CompetingPose& a, const CompetingPose& b) { return a.inliers > b.inliers; });
  return std::move(poses);
}

}  // namespace floorloc
