// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/lattice/floor_lattice.h"
#include "core/lattice/lattice_comparison.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localizer_options.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/search_scope.h"
#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// Matches of a frame as pairs of indices and as pairs of oriented points: matches[i] and oriented[i] are the same
/// match.
struct FrameMatches {
  std::vector<Match> matches;
  std::vector<OrientedMatch> oriented;
};

/// What one frame says of the whole map, found out at most once: on a self-similar map, to compare the poses near the
/// prior with others.
struct GlobalSearchCache {
  std::optional<FrameMatches> matches;
  std::vector<VerifiedPose> poses;
  std::optional<LatticeComparison> places;  ///< relative to the keypoints' origin
};

/// Query keypoints with a match whose residual under the pose is at most radius_m; sorted, without duplicates.
std::vector<int> SupportingKeypoints(const FrameMatches& matches, const Pose2& map_from_base, double radius_m);

/// Finds candidate poses of a frame by votes of its keypoints and verifies each with all of them. Const and
/// thread-safe.
class CandidateSearch {
 public:
  /// Builds the search structures. Refers to the map, which must outlive it. options: scaled to the map's resolution.
  CandidateSearch(const FloorMap& map, DescriptorType descriptors, const LocalizerOptions& options);

  /// First pass: matches that pass the ratio test, or all near neighbours for scope.indistinct. With a guide only every
  /// stride-th keypoint is matched; with headings a keypoint may have one match at each.
  FrameMatches FindMatches(const FrameObservation& frame, const SearchScope& scope) const;

  /// Second pass: matches all keypoints where each pose that the matches vote for predicts them. On a self-similar
  /// floor poses outside the prior are added as rivals.
  std::vector<VerifiedPose> FindPoses(const FrameObservation& frame, const SearchScope& scope,
                                      const FrameMatches& matches, GlobalSearchCache* global) const;

  bool floor_repeats() const { return floor_repeats_; }
  /// The lattice of a self-similar floor that has one: as the map says, or sought in a map that does not say it.
  std::optional<FloorLattice> FindLattice() const;
  /// Matches all keypoints where a pose predicts them.
  VerifiedPose Verify(const FrameObservation& frame, const Pose2& map_from_base) const;
  SearchableMap searchable() const { return {floor_repeats_, upright_index_ != nullptr}; }
  /// Largest descriptor distance at which two keypoints count as similar.
  float max_distance() const { return verifier_.max_distance(); }

 private:
  FrameMatches MatchAtHeadings(const FrameObservation& frame, const SearchScope& scope) const;
  std::vector<VerifiedPose> VerifyCandidates(const FrameObservation& frame, const SearchScope& scope,
                                             const FrameMatches& matches) const;
  void CountOwnAngleInliers(const FrameObservation& frame, std::vector<VerifiedPose>* poses) const;
  bool IsDominated(const PoseCandidate& candidate, const std::vector<VerifiedPose>& verified) const;
  bool ContainsPose(const std::vector<VerifiedPose>& poses, const Pose2& pose) const;
  void AddPosesOutsidePrior(const FrameObservation& frame, const SearchScope& scope, GlobalSearchCache* global,
                            std::vector<VerifiedPose>* poses) const;
  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const;

  const FloorMap& map_;
  LocalizerOptions options_;
  bool binary_;
  std::unique_ptr<DescriptorIndex> index_;
  std::unique_ptr<DescriptorIndex> upright_index_;  // nullptr: the map has no upright descriptors
  GuidedMatcher guided_;
  PoseVerifier verifier_;
  bool floor_repeats_;
  std::optional<PoseVerifier> own_angle_verifier_;  // of a self-similar map that has upright descriptors
};

}  // namespace floorloc
