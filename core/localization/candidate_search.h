// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/localization/localizer_options.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/search_scope.h"
#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// Matches of a frame, twice: matches[i] and oriented[i] are the same.
struct FrameMatches {
  std::vector<Match> matches;
  std::vector<OrientedMatch> oriented;
};

/// What one frame finds on the whole map: looked up at most once, when a prior is doubted.
struct GlobalSearchCache {
  std::optional<FrameMatches> matches;
  std::vector<VerifiedPose> poses;
};

/// Query keypoints of which a match agrees with the pose within radius_m, increasing and each once.
std::vector<int> SupportingKeypoints(const FrameMatches& matches, const Pose2& map_from_base, double radius_m);

/// Finds the poses of a frame that its keypoints vote for, each verified by all of them. Const and thread-safe.
class CandidateSearch {
 public:
  /// Builds the search structures. Refers to the map, which must outlive it. options: scaled to the map's resolution.
  CandidateSearch(const FloorMap& map, DescriptorType descriptors, const LocalizerOptions& options);

  /// First search: distinctive matches; with a guide a part of the keypoints is enough.
  FrameMatches FindMatches(const Features& features, const SearchScope& scope) const;

  /// Second look: all keypoints where each pose that the matches vote for predicts them. On a floor that repeats itself
  /// places outside a prior come along, as rivals.
  std::vector<VerifiedPose> FindPoses(const Features& features, const SearchScope& scope, const FrameMatches& matches,
                                      GlobalSearchCache* global) const;

  bool floor_repeats() const { return floor_repeats_; }
  /// Largest descriptor distance at which two keypoints count as alike.
  float max_distance() const { return verifier_.max_distance(); }

 private:
  std::vector<VerifiedPose> VerifyCandidates(const Features& features, const SearchScope& scope,
                                             const FrameMatches& matches) const;
  bool IsDominated(const PoseCandidate& candidate, const std::vector<VerifiedPose>& verified) const;
  bool ContainsPose(const std::vector<VerifiedPose>& poses, const Pose2& pose) const;
  void AddPosesOutsidePrior(const Features& features, GlobalSearchCache* global,
                            std::vector<VerifiedPose>* poses) const;
  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const;

  const FloorMap& map_;
  LocalizerOptions options_;
  bool binary_;
  std::unique_ptr<DescriptorIndex> index_;
  GuidedMatcher guided_;
  PoseVerifier verifier_;
  bool floor_repeats_;
};

}  // namespace floorloc
