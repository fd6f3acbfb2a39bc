// SPDX-License-Identifier: Apache-2.0
#include "core/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include "core/geometry/option_check.h"
#include "core/registration/least_squares.h"
#include "core/registration/pose_choice.h"
#include "core/registration/significance.h"
#include "core/registration/voting.h"

namespace floorloc {
namespace {

Eigen::Vector2d MeanSource(const std::vector<OrientedMatch>& matches) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const OrientedMatch& m : matches) {
    mean += m.source_m;
  }
  return mean / static_cast<double>(matches.size());
}

std::size_t CountInliers(const std::vector<OrientedMatch>& matches, std::span<const int> subset, const Pose2& pose,
                         double radius_m) {
  const Eigen::Matrix2d rotation = pose.rotation();
  const Eigen::Vector2d translation = pose.translation();
  return static_cast<std::size_t>(std::count_if(subset.begin(), subset.end(), [&](int i) {
    const OrientedMatch& m = matches[static_cast<std::size_t>(i)];
    return (rotation * m.source_m + translation - m.target_m).squaredNorm() <= radius_m * radius_m;
  }));
}

// Two-point RANSAC among the matches of a peak.
Pose2 SampleBestPose(const std::vector<OrientedMatch>& matches, const std::vector<int>& peak,
                     const RegistrationOptions& options) {
  std::mt19937 random(options.seed);
  const auto draw = [&] { return peak[random() % peak.size()]; };
  Pose2 best;
  std::size_t best_count = 0;
  for (int iteration = 0; iteration < options.ransac_iterations; ++iteration) {
    const int pair[2] = {draw(), draw()};
    const OrientedMatch& a = matches[static_cast<std::size_t>(pair[0])];
    const OrientedMatch& b = matches[static_cast<std::size_t>(pair[1])];
    // A rigid motion preserves the distance between two points: most wrong pairs are rejected here.
    const double source_distance = (a.source_m - b.source_m).norm();
    const double target_distance = (a.target_m - b.target_m).norm();
    if (source_distance < 4.0 * options.inlier_radius_m ||
        std::abs(source_distance - target_distance) > 2.0 * options.inlier_radius_m) {
      continue;
    }
    const auto pose = FitRigid(matches, pair);
    if (!pose) {
      continue;
    }
    const std::size_t count = CountInliers(matches, peak, *pose, options.inlier_radius_m);
    if (count > best_count) {
      best_count = count;
      best = *pose;
    }
  }
  return best;
}

// The most significant candidate is the best. A rival's odds follow from its significance; poses that chance explains
// are no rivals.
PoseContest MakeContest(const std::vector<PoseCandidate>& candidates, const RegistrationOptions& options) {
  PoseContest contest;
  const auto best =
      std::min_element(candidates.begin(), candidates.end(),
                       [](const PoseCandidate& a, const PoseCandidate& b) { return a.log10_nfa < b.log10_nfa; });
  if (best == candidates.end()) {
    return contest;
  }
  contest.best = static_cast<std::size_t>(best - candidates.begin());
  contest.p_chance = std::min(1.0, std::pow(10.0, best->log10_nfa));
  for (const PoseCandidate& c : candidates) {
    const bool counts = &c == &*best || c.log10_nfa < options.max_rival_log10_nfa;
    const double odds = counts ? std::pow(10.0, options.inlier_independence * (best->log10_nfa - c.log10_nfa)) : 0.0;
    contest.hypotheses.push_back({c.target_from_source, static_cast<int>(c.inliers.size()), odds});
  }
  return contest;
}

}  // namespace

const char* ToString(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kRegistered:
      return "registered";
    case RegistrationStatus::kAmbiguous:
      return "ambiguous";
    case RegistrationStatus::kTooFewMatches:
      return "too_few_matches";
    case RegistrationStatus::kTooFewInliers:
      return "too_few_inliers";
    case RegistrationStatus::kNotSignificant:
      return "not_significant";
    case RegistrationStatus::kViewDisagrees:
      return "view_disagrees";
  }
  return "unknown";
}

void RegistrationOptions::Check() const {
  RequireOption(inlier_radius_m > 0 && inlier_radius_m < 1, "inlier_radius_m must be between 0 and 1 m");
  RequireOption(vote_cell_m >= inlier_radius_m && vote_cell_m < 10, "vote_cell_m must be inlier_radius_m to 10 m");
  RequireOption(vote_cell_rad > 0.01 && vote_cell_rad < 2, "vote_cell_rad must be 0.01 to 2 rad");
  RequireOption(candidates >= 1 && candidates <= 1000, "candidates must be 1 to 1000");
  RequireOption(ransac_iterations >= 1 && ransac_iterations <= 1000000, "ransac_iterations must be 1 to 1000000");
  RequireOption(min_inliers >= 3, "min_inliers must be at least 3");
  RequireOption(max_p_wrong > 0 && max_p_wrong <= 1, "max_p_wrong must be above 0 and at most 1");
  RequireOption(position_noise_floor_m > 0, "position_noise_floor_m must be positive");
  RequireOption(min_p_wrong >= 0 && min_p_wrong < 1, "min_p_wrong must be at least 0 and below 1");
  RequireOption(max_rival_log10_nfa <= 0, "max_rival_log10_nfa must not be positive");
  RequireOption(inlier_independence > 0 && inlier_independence <= 1,
                "inlier_independence must be above 0 and at most 1");
}

double KeypointNoise(double rms_m, int inliers, const RegistrationOptions& options) {
  // Two residuals per inlier, minus the three parameters of the pose.
  const double degrees_of_freedom = std::max(1.0, 2.0 * inliers - 3.0);
  return std::hypot(rms_m * std::sqrt(inliers / degrees_of_freedom), options.position_noise_floor_m);
}

RegistrationOptions RegistrationOptions::ScaledTo(double resolution_m) const {
  constexpr double kReferenceResolutionM = 7e-4;
  const double scale = resolution_m / kReferenceResolutionM;
  RegistrationOptions scaled = *this;
  scaled.inlier_radius_m *= scale;
  scaled.vote_cell_m *= scale;
  scaled.position_noise_floor_m *= scale;
  return scaled;
}

bool SamePose(const Pose2& a, const Pose2& b, const RegistrationOptions& options) {
  const Pose2 d = a.Between(b);
  return d.translation().norm() < options.vote_cell_m && std::abs(d.yaw()) < options.vote_cell_rad;
}

PoseCandidate RefinePose(const std::vector<OrientedMatch>& matches, const Pose2& start,
                         const RegistrationOptions& options) {
  constexpr int kMaxSteps = 10;
  PoseCandidate candidate{start, FindInliers(matches, start, options.inlier_radius_m), 0.0};
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto pose = FitRigid(matches, candidate.inliers);
    if (!pose) {
      break;
    }
    std::vector<int> inliers = FindInliers(matches, *pose, options.inlier_radius_m);
    candidate.target_from_source = *pose;
    const bool converged = inliers == candidate.inliers;
    candidate.inliers = std::move(inliers);
    if (converged) {
      break;
    }
  }
  return candidate;
}

std::vector<PoseCandidate> FindPoseCandidates(const std::vector<OrientedMatch>& matches,
                                              const RegistrationOptions& options) {
  std::vector<PoseCandidate> candidates;
  if (matches.size() < 2) {
    return candidates;
  }
  for (const VotePeak& peak : FindVotePeaks(matches, MeanSource(matches), options)) {
    if (peak.matches.size() < 2) {
      continue;
    }
    PoseCandidate found = RefinePose(matches, SampleBestPose(matches, peak.matches, options), options);
    const bool known = std::any_of(candidates.begin(), candidates.end(), [&](const PoseCandidate& c) {
      return SamePose(c.target_from_source, found.target_from_source, options);
    });
    if (!known && found.inliers.size() >= 2) {
      candidates.push_back(std::move(found));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PoseCandidate& a, const PoseCandidate& b) { return a.inliers.size() > b.inliers.size(); });
  return candidates;
}

double Log10NfaOfPose(int matches, int inliers, const SearchRegion& region, const RegistrationOptions& options) {
  const double disc_m2 = std::numbers::pi * options.inlier_radius_m * options.inlier_radius_m;
  const double chance = std::max(disc_m2 / std::max(region.area_m2, disc_m2), 1e-7);
  // Two matches define the pose: only the others are evidence.
  return Log10Nfa(matches - 2, inliers - 2, chance, std::max(1.0, 0.5 * matches * (matches - 1.0)));
}

RegistrationResult RegisterSe2(const std::vector<OrientedMatch>& matches, const SearchRegion& region,
                               const RegistrationOptions& options) {
  RegistrationResult result;
  if (static_cast<int>(matches.size()) < options.min_inliers) {
    return result;
  }
  std::vector<PoseCandidate> candidates = FindPoseCandidates(matches, options);
  for (PoseCandidate& c : candidates) {
    c.log10_nfa = Log10NfaOfPose(static_cast<int>(matches.size()), static_cast<int>(c.inliers.size()), region, options);
  }
  PoseDecision choice = ChoosePose(MakeContest(candidates, options), options);
  result.status = choice.status;
  if (choice.best < 0) {
    return result;
  }
  const PoseCandidate& best = candidates[static_cast<std::size_t>(choice.best)];
  result.target_from_source = best.target_from_source;
  result.inliers = best.inliers;
  result.rms_m = RmsResidual(matches, best.inliers, best.target_from_source);
  const double noise_m = KeypointNoise(result.rms_m, static_cast<int>(best.inliers.size()), options);
  result.covariance = PoseCovariance(matches, best.inliers, best.target_from_source, noise_m);
  result.p_wrong = choice.p_wrong;
  result.alternatives = std::move(choice.alternatives);
  return result;
}

}  // namespace floorloc
