// SPDX-License-Identifier: Apache-2.0
#include "core/localization/candidate_search.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

#include "core/lattice/lattice_regions.h"
#include "core/lattice/self_similarity.h"
#include "core/localization/oriented_matches.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 70.0;

// The keypoints that a search at given headings takes: every stride-th one near a prior, the strongest ones in the
// whole map.
std::vector<int> ChooseKeypoints(const std::vector<Keypoint>& keypoints, const SearchScope& scope) {
  std::vector<int> chosen;
  const int stride = scope.guide ? scope.guide->stride : 1;
  for (int i = 0; i < static_cast<int>(keypoints.size()); i += stride) {
    chosen.push_back(i);
  }
  if (scope.strongest > 0 && static_cast<std::size_t>(scope.strongest) < chosen.size()) {
    std::stable_sort(chosen.begin(), chosen.end(), [&](int a, int b) {
      return keypoints[static_cast<std::size_t>(a)].response > keypoints[static_cast<std::size_t>(b)].response;
    });
    chosen.resize(static_cast<std::size_t>(scope.strongest));
  }
  return chosen;
}

// Poses modulo the lattice, each at the place where most of its matches are.
std::vector<PoseCandidate> FindModulo(const FloorLattice& lattice, const FrameMatches& found,
                                      const LocalizerOptions& options) {
  std::vector<OrientedMatch> folded = found.oriented;
  std::vector<Eigen::Vector2i> places;
  for (OrientedMatch& match : folded) {
    const Eigen::Vector2d base = match.target_m - Pose2(0.0, 0.0, match.Yaw()) * match.source_m;
    places.push_back(lattice.Nearest(base));
    match.target_m -= lattice.basis * places.back().cast<double>();
  }
  RegistrationOptions registration = options.registration;
  registration.candidates = options.search.modulo_candidates;
  std::vector<PoseCandidate> candidates = FindPoseCandidates(folded, registration);
  for (PoseCandidate& candidate : candidates) {
    std::map<std::pair<int, int>, int> votes;
    for (const int i : candidate.inliers) {
      const Eigen::Vector2i& place = places[static_cast<std::size_t>(i)];
      ++votes[{place.x(), place.y()}];
    }
    const auto most =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != votes.end()) {
      const Pose2& pose = candidate.target_from_source;
      const Eigen::Vector2d moved = lattice.basis * Eigen::Vector2d(most->first.first, most->first.second);
      candidate.target_from_source = Pose2(pose.x() + moved.x(), pose.y() + moved.y(), pose.yaw());
    }
  }
  return candidates;
}

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
      upright_index_(map.keypoints.upright.empty() ? nullptr
                                                   : CreateDescriptorIndex(map.keypoints.upright, options.index)),
      guided_(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellPx * map.info.camera().floor.resolution_m,
              map.keypoints.upright),
      verifier_(map, guided_, options.registration, options.verification,
                upright_index_ == nullptr ? VerifiedBy::kOwnAngles : VerifiedBy::kUpright),
      floor_repeats_(IsSelfSimilar(map.keypoints, *index_, options.self_similarity, options.registration.seed)) {
  if (floor_repeats_ && upright_index_ != nullptr) {
    own_angle_verifier_.emplace(map, guided_, options.registration, options.verification, VerifiedBy::kOwnAngles);
  }
}

std::optional<FloorLattice> CandidateSearch::FindLattice() const {
  if (!floor_repeats_) {
    return std::nullopt;
  }
  const std::optional<FloorLattice> stored = LargestLattice(map_.info);
  return stored ? stored : FindFloorLattice(map_.keypoints, *index_, options_.lattice, options_.registration.seed);
}

FrameMatches CandidateSearch::FindMatches(const FrameObservation& frame, const SearchScope& scope) const {
  if (!scope.headings.empty()) {
    return MatchAtHeadings(frame, scope);
  }
  const Features& features = frame.features;
  FrameMatches found;
  if (scope.indistinct && binary_) {
    const SearchOptions& o = options_.search;
    NeighbourSearch near{.count = o.votes_per_keypoint, .max_distance = o.max_vote_distance};
    if (scope.modulo) {
      near = {.count = o.modulo_votes, .max_distance = o.modulo_distance};
    } else if (scope.thorough) {
      near = {.count = o.thorough_votes, .max_distance = o.thorough_vote_distance};
    }
    found.matches = FindAllNear(*index_, features.descriptors, near);
  } else {
    const float max_ratio = binary_ ? options_.max_ratio_binary : options_.max_ratio_float;
    found.matches = FilterByRatio(scope.guide ? guided_.FindNearest(features, *scope.guide)
                                              : FindNearest(*index_, features.descriptors, scope.probes),
                                  scope.thorough ? 1.0F : max_ratio);
  }
  found.oriented = ToOrientedMatches(found.matches, features.keypoints, map_.keypoints.keypoints);
  return found;
}

// Matches vote for the heading at which they were found: the keypoints' own angles have no say.
FrameMatches CandidateSearch::MatchAtHeadings(const FrameObservation& frame, const SearchScope& scope) const {
  const std::vector<int> chosen = ChooseKeypoints(frame.features.keypoints, scope);
  Features query;
  for (const int i : chosen) {
    query.keypoints.push_back(frame.features.keypoints[static_cast<std::size_t>(i)]);
  }
  FrameMatches found;
  for (const double heading : scope.headings) {
    query.descriptors = DescribeUpright(frame.upright, query.keypoints, heading);
    std::vector<Match> nearest;
    if (scope.guide) {
      MatchGuide guide = *scope.guide;
      guide.target_from_query = {guide.target_from_query.x(), guide.target_from_query.y(), heading};
      guide.stride = 1;
      guide.upright = true;
      nearest = FilterByRatio(guided_.FindNearest(query, guide), scope.thorough ? 1.0F : options_.max_ratio_binary);
    } else {
      const SearchOptions& o = options_.search;
      NeighbourSearch near{.count = o.votes_per_keypoint, .max_distance = o.max_vote_distance};
      if (scope.modulo) {
        near = {.count = o.modulo_votes, .max_distance = o.modulo_distance};
      } else if (scope.thorough) {
        near = {.count = o.thorough_heading_votes, .max_distance = o.thorough_heading_distance};
      }
      nearest = FindAllNear(*upright_index_, query.descriptors, near);
    }
    for (Match match : nearest) {
      const Keypoint& from = query.keypoints[static_cast<std::size_t>(match.query)];
      const Keypoint& to = map_.keypoints.keypoints[static_cast<std::size_t>(match.train)];
      match.query = chosen[static_cast<std::size_t>(match.query)];
      found.matches.push_back(match);
      found.oriented.push_back({from.Position(), to.Position(), 0.0, heading});
    }
  }
  return found;
}

std::vector<VerifiedPose> CandidateSearch::FindPoses(const FrameObservation& frame, const SearchScope& scope,
                                                     const FrameMatches& matches, GlobalSearchCache* global) const {
  std::vector<VerifiedPose> poses = VerifyCandidates(frame, scope, matches);
  if (scope.prior && floor_repeats_ && !poses.empty() && !scope.IsUnquestioned(options_.search)) {
    AddPosesOutsidePrior(frame, scope, global, &poses);
  }
  CountOwnAngleInliers(frame, &poses);
  return poses;
}

void CandidateSearch::CountOwnAngleInliers(const FrameObservation& frame, std::vector<VerifiedPose>* poses) const {
  if (!own_angle_verifier_) {
    return;
  }
  for (VerifiedPose& pose : *poses) {
    const VerifiedPose again = own_angle_verifier_->Verify(frame.features, pose.candidate.target_from_source);
    pose.own_angle_inliers = static_cast<int>(again.candidate.inliers.size());
  }
}

// Candidates that converge to the same pose are kept once.
std::vector<VerifiedPose> CandidateSearch::VerifyCandidates(const FrameObservation& frame, const SearchScope& scope,
                                                            const FrameMatches& matches) const {
  const SearchRegion region = RegionOf(scope.guide);
  std::vector<VerifiedPose> verified;
  RegistrationOptions registration = options_.registration;
  if (scope.thorough) {
    registration.candidates = options_.search.thorough_candidates;
  }
  const std::vector<PoseCandidate> candidates =
      scope.modulo ? FindModulo(*scope.modulo, matches, options_) : FindPoseCandidates(matches.oriented, registration);
  for (const PoseCandidate& candidate : candidates) {
    if (IsDominated(candidate, verified)) {
      continue;
    }
    VerifiedPose pose = Verify(frame, candidate.target_from_source);
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

VerifiedPose CandidateSearch::Verify(const FrameObservation& frame, const Pose2& map_from_base) const {
  if (upright_index_ == nullptr) {
    return verifier_.Verify(frame.features, map_from_base);
  }
  const std::vector<Keypoint>& keypoints = frame.features.keypoints;
  return verifier_.Verify({keypoints, DescribeUpright(frame.upright, keypoints, map_from_base.yaw())}, map_from_base);
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
void CandidateSearch::AddPosesOutsidePrior(const FrameObservation& frame, const SearchScope& scope,
                                           GlobalSearchCache* global, std::vector<VerifiedPose>* poses) const {
  if (!global->matches) {
    const SearchScope whole;
    global->matches = FindMatches(frame, whole);
    global->poses = VerifyCandidates(frame, whole, *global->matches);
  }
  for (VerifiedPose& pose : *poses) {
    pose.supporting_keypoints =
        SupportingKeypoints(*global->matches, pose.candidate.target_from_source, options_.registration.inlier_radius_m);
  }
  for (const VerifiedPose& pose : global->poses) {
    if (!ContainsPose(*poses, pose.candidate.target_from_source)) {
      poses->push_back(pose);
      poses->back().prior_weight = scope.WeightOutside(options_.search);
      poses->back().outside_prior = poses->back().prior_weight < 1.0;
    }
  }
}

SearchRegion CandidateSearch::RegionOf(const std::optional<MatchGuide>& guide) const {
  return {guide ? std::numbers::pi * guide->radius_m * guide->radius_m : std::max(map_.info.area_m2, 0.01)};
}

}  // namespace floorloc
