// SPDX-License-Identifier: Apache-2.0
#include "core/localization/candidate_search.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/localization/oriented_matches.h"
#include "core/localization/self_similarity.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 70.0;

}  // namespace

std::vector<int> SupportingKeypoints(const FrameMatches& matches, const Pose2& map_from_base, double radius_m) {
  std::vector<int> keypoints;
  for (const int i : FindInliers(matches.oriented, map_from_base, radius_m)) {
    keypoints.push_back(matches.matches[static_cast<std::size_t>(i)].query);
  }
  std::sort(keypoints.begin(), keypoints.end());
  keypoints.erase(std::unique(keypoints.begin(), keypoints.end()), keypoints.end());
  return keypoints;
}

CandidateSearch::CandidateSearch(const FloorMap& map, DescriptorType descriptors, const LocalizerOptions& options)
    : map_(map),
      options_(options),
      binary_(descriptors == DescriptorType::kBinary),
      index_(CreateDescriptorIndex(map.keypoints.descriptors, options.index)),
      guided_(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellPx * map.info.camera().floor.resolution_m),
      verifier_(map, guided_, options.registration, options.verification),
      floor_repeats_(IsSelfSimilar(map.keypoints, *index_, options.self_similarity, options.registration.seed)) {}

FrameMatches CandidateSearch::FindMatches(const Features& features, const SearchScope& scope) const {
  FrameMatches found;
  if (scope.indistinct && binary_) {
    const SearchOptions& o = options_.search;
    found.matches = FindAllNear(*index_, features.descriptors,
                                {.count = scope.thorough ? o.thorough_votes : o.votes_per_keypoint,
                                 .max_distance = scope.thorough ? o.thorough_vote_distance : o.max_vote_distance});
  } else {
    const float max_ratio = binary_ ? options_.max_ratio_binary : options_.max_ratio_float;
    found.matches = FilterByRatio(scope.guide ? guided_.FindNearest(features, *scope.guide)
                                              : FindNearest(*index_, features.descriptors, scope.probes),
                                  scope.thorough ? 1.0F : max_ratio);
  }
  found.oriented = ToOrientedMatches(found.matches, features.keypoints, map_.keypoints.keypoints);
  return found;
}

std::vector<VerifiedPose> CandidateSearch::FindPoses(const Features& features, const SearchScope& scope,
                                                     const FrameMatches& matches, GlobalSearchCache* global) const {
  std::vector<VerifiedPose> poses = VerifyCandidates(features, scope, matches);
  if (scope.prior && floor_repeats_ && !poses.empty()) {
    AddPosesOutsidePrior(features, global, &poses);
  }
  return poses;
}

// Candidates that converge to the same pose are kept once.
std::vector<VerifiedPose> CandidateSearch::VerifyCandidates(const Features& features, const SearchScope& scope,
                                                            const FrameMatches& matches) const {
  const SearchRegion region = RegionOf(scope.guide);
  std::vector<VerifiedPose> verified;
  RegistrationOptions registration = options_.registration;
  if (scope.thorough) {
    registration.candidates = options_.search.thorough_candidates;
  }
  for (const PoseCandidate& candidate : FindPoseCandidates(matches.oriented, registration)) {
    if (IsDominated(candidate, verified)) {
      continue;
    }
    VerifiedPose pose = verifier_.Verify(features, candidate.target_from_source);
    const Pose2& refined = pose.candidate.target_from_source;
    if (!ContainsPose(verified, refined) && scope.Contains(refined)) {
      pose.supporting_keypoints = SupportingKeypoints(matches, refined, options_.registration.inlier_radius_m);
      pose.support_log10_nfa =
          Log10NfaOfPose(static_cast<int>(matches.matches.size()), static_cast<int>(pose.supporting_keypoints.size()),
                         region, options_.registration);
      verified.push_back(std::move(pose));
    }
  }
  return verified;
}

bool CandidateSearch::IsDominated(const PoseCandidate& candidate, const std::vector<VerifiedPose>& verified) const {
  return !floor_repeats_ && !verified.empty() &&
         verified.front().candidate.log10_nfa < options_.search.clear_log10_nfa &&
         static_cast<double>(candidate.inliers.size()) <
             options_.search.min_rival_share * static_cast<double>(verified.front().supporting_keypoints.size());
}

bool CandidateSearch::ContainsPose(const std::vector<VerifiedPose>& poses, const Pose2& pose) const {
  return std::any_of(poses.begin(), poses.end(), [&](const VerifiedPose& v) {
    return SamePose(v.candidate.target_from_source, pose, options_.registration);
  });
}

// On a self-similar floor a similar place would confirm a wrong prior: poses outside it compete, and all are compared
// by the matches that are distinctive on the whole map.
void CandidateSearch::AddPosesOutsidePrior(const Features& features, GlobalSearchCache* global,
                                           std::vector<VerifiedPose>* poses) const {
  if (!global->matches) {
    const SearchScope whole;
    global->matches = FindMatches(features, whole);
    global->poses = VerifyCandidates(features, whole, *global->matches);
  }
  for (VerifiedPose& pose : *poses) {
    pose.supporting_keypoints =
        SupportingKeypoints(*global->matches, pose.candidate.target_from_source, options_.registration.inlier_radius_m);
  }
  for (const VerifiedPose& pose : global->poses) {
    if (!ContainsPose(*poses, pose.candidate.target_from_source)) {
      poses->push_back(pose);
      poses->back().outside_prior = true;
      poses->back().prior_weight = options_.search.prior_failure_rate;
    }
  }
}

SearchRegion CandidateSearch::RegionOf(const std::optional<MatchGuide>& guide) const {
  return {guide ? std::numbers::pi * guide->radius_m * guide->radius_m : std::max(map_.info.area_m2, 0.01)};
}

}  // namespace floorloc
