// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pair_registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>

#include "core/geometry/option_check.h"
#include "core/localization/oriented_matches.h"
#include "core/registration/systematic_covariance.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 40.0;

// Search radius around a keypoint's prediction, in inlier radii.
constexpr double kRefineRadii = 1.5;

MatchGuide GuideOf(const FramePair& pair) {
  if (pair.first_from_second) {
    return {*pair.first_from_second, pair.radius_m, pair.yaw_radius_rad + kKeypointAngleNoiseRad};
  }
  constexpr double kAnywhereM = 1e3;
  return {Pose2(), kAnywhereM, std::numbers::pi};
}

std::vector<OrientedMatch> FindMatches(const GuidedMatcher& matcher, const Features& first, const Features& second,
                                       const MatchGuide& guide, const PairRegistrationOptions& options) {
  const float ratio = first.descriptors.depth() == CV_8U ? options.max_ratio_binary : options.max_ratio_float;
  return ToOrientedMatches(FilterByRatio(matcher.FindNearest(second, guide), ratio), second.keypoints, first.keypoints);
}

double MaxSimilarDistance(const Features& features, const PairRegistrationOptions& options) {
  if (features.descriptors.depth() == CV_8U) {
    return options.max_similar_bits * 8.0 * features.descriptors.cols;
  }
  return options.max_similar_norm * cv::norm(features.descriptors.row(0), cv::NORM_L2);
}

// Scale of a similarity through the inliers, whose residuals are small: of the second moments about the means.
double ScaleOf(const std::vector<OrientedMatch>& matches, const RegistrationResult& result) {
  const auto count = static_cast<double>(result.inliers.size());
  Eigen::Vector2d source = Eigen::Vector2d::Zero();
  for (const int i : result.inliers) {
    source += matches[static_cast<std::size_t>(i)].source_m / count;
  }
  const Eigen::Vector2d target = MeanTarget(matches, result.inliers);
  const Pose2 turn(0.0, 0.0, result.target_from_source.yaw());
  double along = 0.0;
  double spread = 0.0;
  for (const int i : result.inliers) {
    const OrientedMatch& match = matches[static_cast<std::size_t>(i)];
    const Eigen::Vector2d turned = turn * Eigen::Vector2d(match.source_m - source);
    along += turned.dot(match.target_m - target);
    spread += turned.squaredNorm();
  }
  return spread > 0.0 && along > 0.0 ? along / spread : 1.0;
}

Link MakeLink(const FramePair& pair, const std::vector<OrientedMatch>& matches, const RegistrationResult& result,
              const PairRegistrationOptions& options) {
  Link link;
  link.first = pair.first;
  link.second = pair.second;
  link.first_from_second = result.target_from_source;
  // Calibration errors rotate and shift the overlap about its centre, not about the origin of the base frame.
  link.covariance =
      result.covariance + SystematicCovariance(result.target_from_source, MeanTarget(matches, result.inliers),
                                               {options.systematic_m, options.systematic_rad});
  link.inliers = static_cast<int>(result.inliers.size());
  link.rms_m = result.rms_m;
  link.scale = ScaleOf(matches, result);
  return link;
}

// A significant relative pose, with the similarity of the frames under it.
struct Hypothesis {
  Pose2 first_from_second;
  PairAgreement agreement;
};

// Sorted, best first.
std::vector<Hypothesis> FindHypotheses(const GuidedMatcher& matcher, const Features& second, const RectM& floor,
                                       const std::vector<OrientedMatch>& matches,
                                       const PairRegistrationOptions& options) {
  const RegistrationOptions registration = options.registration.ScaledTo(options.resolution_m);
  const SearchRegion region{floor.width_m() * floor.height_m()};
  std::vector<Hypothesis> hypotheses;
  for (const PoseCandidate& candidate : FindPoseCandidates(matches, registration)) {
    const int inliers = static_cast<int>(candidate.inliers.size());
    if (inliers < registration.min_inliers || Log10NfaOfPose(static_cast<int>(matches.size()), inliers, region,
                                                             registration) > std::log10(registration.max_p_wrong)) {
      continue;
    }
    hypotheses.push_back({candidate.target_from_source,
                          MeasureAgreement(matcher, second, floor, candidate.target_from_source, options)});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.agreement.mean > b.agreement.mean; });
  return hypotheses;
}

// No prior on the relative pose: compares all significant ones.
std::optional<Link> RegisterAnywhere(const Features& first, const Features& second, const RectM& floor,
                                     const FramePair& pair, const PairRegistrationOptions& options) {
  const GuidedMatcher matcher(first.keypoints, first.descriptors, kGridCellPx * options.resolution_m);
  const std::vector<OrientedMatch> all = FindMatches(matcher, first, second, GuideOf(pair), options);
  const std::vector<Hypothesis> hypotheses = FindHypotheses(matcher, second, floor, all, options);
  if (hypotheses.empty()) {
    return std::nullopt;
  }
  const PairAgreement& best = hypotheses.front().agreement;
  const PairAgreement rival = hypotheses.size() > 1 ? hypotheses[1].agreement : PairAgreement{0.0, 0.0};
  if (hypotheses.size() > 1 &&
      best.mean - rival.mean < options.min_lead * std::hypot(best.standard_error, rival.standard_error)) {
    return std::nullopt;
  }
  const RegistrationOptions registration = options.registration.ScaledTo(options.resolution_m);
  const MatchGuide guide{hypotheses.front().first_from_second, kRefineRadii * registration.inlier_radius_m,
                         kKeypointAngleNoiseRad};
  const std::vector<OrientedMatch> matches = FindMatches(matcher, first, second, guide, options);
  const RegistrationResult result = RegisterSe2(matches, {floor.width_m() * floor.height_m()}, registration);
  if (!result.ok()) {
    return std::nullopt;
  }
  Link link = MakeLink(pair, matches, result, options);
  link.agreement = best.mean;
  link.rival_agreement = rival.mean;
  return link;
}

std::optional<Link> RegisterNear(const Features& first, const Features& second, const RectM& floor,
                                 const FramePair& pair, const PairRegistrationOptions& options) {
  const GuidedMatcher matcher(first.keypoints, first.descriptors, kGridCellPx * options.resolution_m);
  const std::vector<OrientedMatch> matches = FindMatches(matcher, first, second, GuideOf(pair), options);
  const RegistrationResult result = RegisterSe2(matches, {std::numbers::pi * pair.radius_m * pair.radius_m},
                                                options.registration.ScaledTo(options.resolution_m));
  if (!result.ok()) {
    return std::nullopt;
  }
  Link link = MakeLink(pair, matches, result, options);
  if (options.measure_agreement) {
    link.agreement = MeasureAgreement(matcher, second, floor, link.first_from_second, options).mean;
  }
  return link;
}

std::optional<Link> RegisterPair(const std::vector<BuildFrame>& frames, const RectM& floor, const FramePair& pair,
                                 const PairRegistrationOptions& options) {
  const Features& first = frames[static_cast<std::size_t>(pair.first)].features;
  const Features& second = frames[static_cast<std::size_t>(pair.second)].features;
  if (first.keypoints.empty() || second.keypoints.empty()) {
    return std::nullopt;
  }
  return pair.first_from_second ? RegisterNear(first, second, floor, pair, options)
                                : RegisterAnywhere(first, second, floor, pair, options);
}

}  // namespace

RegistrationOptions PairRegistrationOptions::DefaultRegistration() {
  RegistrationOptions registration;
  registration.min_inliers = 12;
  registration.max_p_wrong = 1e-5;
  return registration;
}

PairAgreement MeasureAgreement(const GuidedMatcher& first, const Features& second, const RectM& floor,
                               const Pose2& first_from_second, const PairRegistrationOptions& options) {
  const RegistrationOptions registration = options.registration.ScaledTo(options.resolution_m);
  const double largest = MaxSimilarDistance(second, options);
  std::vector<double> similarity(second.keypoints.size(), 0.0);
  const MatchGuide guide{first_from_second, kRefineRadii * registration.inlier_radius_m, kKeypointAngleNoiseRad};
  for (const Match& match : first.FindNearest(second, guide)) {
    similarity[static_cast<std::size_t>(match.query)] = std::max(0.0, 1.0 - match.distance / largest);
  }
  double sum = 0.0;
  double squares = 0.0;
  int shared = 0;
  for (std::size_t i = 0; i < similarity.size(); ++i) {
    if (floor.Contains(first_from_second * second.keypoints[i].Position())) {
      ++shared;
      sum += similarity[i];
      squares += similarity[i] * similarity[i];
    }
  }
  if (shared < options.min_shared_keypoints) {
    return {};
  }
  const double mean = sum / shared;
  return {mean, std::sqrt(std::max(0.0, squares / shared - mean * mean) / shared)};
}

void PairRegistrationOptions::Check() const {
  registration.Check();
  RequireOption(resolution_m > 0.0 && resolution_m < 1.0, "resolution_m must be between 0 and 1 m");
  RequireOption(max_ratio_binary > 0.0F && max_ratio_binary <= 1.0F, "max_ratio_binary must be above 0 and at most 1");
  RequireOption(max_ratio_float > 0.0F && max_ratio_float <= 1.0F, "max_ratio_float must be above 0 and at most 1");
  RequireOption(systematic_m >= 0.0, "systematic_m must not be negative");
  RequireOption(systematic_rad >= 0.0, "systematic_rad must not be negative");
  RequireOption(min_lead >= 0.0, "min_lead must not be negative");
  RequireOption(max_similar_bits > 0.0 && max_similar_bits <= 1.0, "max_similar_bits must be above 0 and at most 1");
  RequireOption(max_similar_norm > 0.0 && max_similar_norm <= 2.0, "max_similar_norm must be above 0 and at most 2");
  RequireOption(min_shared_keypoints > 0, "min_shared_keypoints must be positive");
  run.Check();
}

std::vector<Link> RegisterPairs(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                const std::vector<FramePair>& pairs, const PairRegistrationOptions& options) {
  options.Check();
  std::vector<std::optional<Link>> found(pairs.size());
  ProgressBar progress("registration", static_cast<std::int64_t>(pairs.size()), options.run.progress);
  ParallelFor(static_cast<int>(pairs.size()), options.run.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const RectM& floor = floor_in_base[static_cast<std::size_t>(pairs[index].first)];
    found[index] = RegisterPair(frames, floor, pairs[index], options);
    progress.Advance();
  });
  std::vector<Link> links;
  for (const std::optional<Link>& link : found) {
    if (link) {
      links.push_back(*link);
    }
  }
  return links;
}

}  // namespace floorloc
