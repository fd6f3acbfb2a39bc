// SPDX-License-Identifier: Apache-2.0
#include "core/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <span>
#include <stdexcept>

#include "core/registration/least_squares.h"
#include "core/registration/significance.h"
#include "core/registration/voting.h"

namespace floorloc {
namespace {

struct Candidate {
  Pose2 pose;
  std::vector<int> inliers;
};

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
    // The distance between two points survives the motion: most wrong pairs end here.
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

// Alternates between the inliers of all matches and the fit to them until they agree.
Candidate Refine(const std::vector<OrientedMatch>& matches, const Pose2& start, const RegistrationOptions& options) {
  constexpr int kMaxSteps = 10;
  Candidate candidate{start, FindInliers(matches, start, options.inlier_radius_m)};
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto pose = FitRigid(matches, candidate.inliers);
    if (!pose) {
      break;
    }
    std::vector<int> inliers = FindInliers(matches, *pose, options.inlier_radius_m);
    candidate.pose = *pose;
    const bool converged = inliers == candidate.inliers;
    candidate.inliers = std::move(inliers);
    if (converged) {
      break;
    }
  }
  return candidate;
}

bool SamePose(const Pose2& a, const Pose2& b, const RegistrationOptions& options) {
  const Pose2 d = a.Between(b);
  return d.translation().norm() < options.vote_cell_m && std::abs(d.yaw()) < options.vote_cell_rad;
}

std::vector<Candidate> FindCandidates(const std::vector<OrientedMatch>& matches, const RegistrationOptions& options) {
  std::vector<Candidate> candidates;
  for (const VotePeak& peak : FindVotePeaks(matches, MeanSource(matches), options)) {
    if (peak.matches.size() < 2) {
      continue;
    }
    Candidate found = Refine(matches, SampleBestPose(matches, peak.matches, options), options);
    const bool known = std::any_of(candidates.begin(), candidates.end(),
                                   [&](const Candidate& c) { return SamePose(c.pose, found.pose, options); });
    if (!known && found.inliers.size() >= 2) {
      candidates.push_back(std::move(found));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.inliers.size() > b.inliers.size(); });
  return candidates;
}

// Probability that a match that is wrong agrees with a wrong pose, and how many poses were tried: each match proposes
// one, and the cells they fall into bound the number of different ones.
double LogFalseAlarms(int matches, int inliers, const SearchRegion& region, const RegistrationOptions& options) {
  const double radius = options.inlier_radius_m;
  const double chance = std::numbers::pi * radius * radius / std::max(region.area_m2, radius * radius);
  // Two matches define the pose: only the others are evidence.
  return LogNumberOfFalseAlarms(matches - 2, inliers - 2, std::max(chance, 1e-7),
                                std::max(1.0, 0.5 * matches * (matches - 1.0)));
}

// A rival that explains nearly as many matches is as probable as its significance says; rivals that chance alone
// explains are no rivals.
std::vector<double> PosteriorWeights(const std::vector<double>& log_false_alarms) {
  constexpr double kMinSignificance = -1.0;
  // Inliers of one pose are not independent (neighbouring keypoints share pixels): temper the likelihood ratio.
  constexpr double kTemper = 0.2;
  const double best = *std::min_element(log_false_alarms.begin(), log_false_alarms.end());
  std::vector<double> weights;
  double sum = 0.0;
  for (const double log_nfa : log_false_alarms) {
    const bool counts = log_nfa == best || log_nfa < kMinSignificance;
    weights.push_back(counts ? std::pow(10.0, kTemper * (best - log_nfa)) : 0.0);
    sum += weights.back();
  }
  for (double& w : weights) {
    w /= sum;
  }
  return weights;
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
  }
  return "unknown";
}

void RegistrationOptions::Check() const {
  const auto require = [](bool ok, const char* message) {
    if (!ok) {
      throw std::invalid_argument(message);
    }
  };
  require(inlier_radius_m > 0 && inlier_radius_m < 1, "inlier_radius_m must be between 0 and 1 m");
  require(vote_cell_m >= inlier_radius_m && vote_cell_m < 10, "vote_cell_m must be inlier_radius_m to 10 m");
  require(vote_cell_rad > 0.01 && vote_cell_rad < 2, "vote_cell_rad must be 0.01 to 2 rad");
  require(candidates >= 1 && candidates <= 1000, "candidates must be 1 to 1000");
  require(ransac_iterations >= 1 && ransac_iterations <= 1000000, "ransac_iterations must be 1 to 1000000");
  require(min_inliers >= 3, "min_inliers must be at least 3");
  require(max_p_wrong > 0 && max_p_wrong <= 1, "max_p_wrong must be above 0 and at most 1");
  require(position_noise_floor_m > 0, "position_noise_floor_m must be positive");
}

RegistrationResult RegisterSe2(const std::vector<OrientedMatch>& matches, const SearchRegion& region,
                               const RegistrationOptions& options) {
  RegistrationResult result;
  if (static_cast<int>(matches.size()) < options.min_inliers) {
    return result;
  }
  std::vector<Candidate> candidates = FindCandidates(matches, options);
  if (candidates.empty() || static_cast<int>(candidates.front().inliers.size()) < options.min_inliers) {
    result.status = RegistrationStatus::kTooFewInliers;
    return result;
  }
  std::vector<double> log_nfa;
  for (const Candidate& c : candidates) {
    log_nfa.push_back(LogFalseAlarms(static_cast<int>(matches.size()), static_cast<int>(c.inliers.size()), region,
                                     options));
  }
  const std::vector<double> weights = PosteriorWeights(log_nfa);
  const Candidate& best = candidates.front();
  result.target_from_source = best.pose;
  result.inliers = best.inliers;
  result.rms_m = RmsResidual(matches, best.inliers, best.pose);
  const double sigma = std::hypot(result.rms_m / std::numbers::sqrt2, options.position_noise_floor_m);
  result.covariance = PoseCovariance(matches, best.inliers, best.pose, sigma);
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (weights[i] > options.max_p_wrong) {
      result.alternatives.push_back({candidates[i].pose, static_cast<int>(candidates[i].inliers.size()), weights[i]});
    }
  }
  const double p_chance = std::min(1.0, std::pow(10.0, log_nfa.front()));
  const double p_rival = 1.0 - weights.front();
  result.p_wrong = std::min(1.0, p_chance + p_rival);
  if (p_chance > options.max_p_wrong) {
    result.status = RegistrationStatus::kNotSignificant;
  } else if (result.p_wrong > options.max_p_wrong) {
    result.status = RegistrationStatus::kAmbiguous;
    result.alternatives.insert(result.alternatives.begin(),
                               {best.pose, static_cast<int>(best.inliers.size()), weights.front()});
  } else {
    result.status = RegistrationStatus::kRegistered;
  }
  return result;
}

}  // namespace floorloc
