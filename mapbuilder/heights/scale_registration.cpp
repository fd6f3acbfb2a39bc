// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/scale_registration.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/localization/oriented_matches.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

using Complex = std::complex<double>;

constexpr int kRefinements = 5;

Complex ToComplex(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

double ResidualM(const OrientedMatch& match, const Similarity& similarity) {
  return std::abs(similarity.factor * ToComplex(match.source_m) + similarity.shift - ToComplex(match.target_m));
}

std::vector<int> InliersOf(const std::vector<OrientedMatch>& matches, const Similarity& similarity, double radius_m) {
  const double yaw = std::arg(similarity.factor);
  std::vector<int> inliers;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (ResidualM(matches[i], similarity) <= radius_m &&
        std::abs(WrapAngle(matches[i].Yaw() - yaw)) <= kKeypointAngleNoiseRad) {
      inliers.push_back(static_cast<int>(i));
    }
  }
  return inliers;
}

std::optional<Similarity> OfTwo(const OrientedMatch& a, const OrientedMatch& b, double max_scale) {
  const Complex from = ToComplex(b.source_m) - ToComplex(a.source_m);
  if (std::abs(from) <= 0.0) {
    return std::nullopt;
  }
  Similarity similarity;
  similarity.factor = (ToComplex(b.target_m) - ToComplex(a.target_m)) / from;
  similarity.shift = ToComplex(a.target_m) - similarity.factor * ToComplex(a.source_m);
  const bool possible = similarity.scale() > 1.0 / max_scale && similarity.scale() < max_scale;
  return possible ? std::optional(similarity) : std::nullopt;
}

// Least squares (Umeyama 1991, in the plane), with the standard deviation of the scale's logarithm.
Similarity FitTo(const std::vector<OrientedMatch>& matches, std::vector<int> inliers) {
  const auto count = static_cast<double>(inliers.size());
  Complex from = 0.0;
  Complex to = 0.0;
  for (const int i : inliers) {
    from += ToComplex(matches[static_cast<std::size_t>(i)].source_m) / count;
    to += ToComplex(matches[static_cast<std::size_t>(i)].target_m) / count;
  }
  Complex product = 0.0;
  double spread = 0.0;
  for (const int i : inliers) {
    const Complex s = ToComplex(matches[static_cast<std::size_t>(i)].source_m) - from;
    product += std::conj(s) * (ToComplex(matches[static_cast<std::size_t>(i)].target_m) - to);
    spread += std::norm(s);
  }
  Similarity fit;
  fit.factor = spread > 0.0 ? product / spread : Complex(1.0);
  fit.shift = to - fit.factor * from;
  double squares = 0.0;
  for (const int i : inliers) {
    squares += std::pow(ResidualM(matches[static_cast<std::size_t>(i)], fit), 2);
  }
  const double variance = squares / std::max(1.0, 2.0 * count - 4.0);
  fit.log_sigma = spread > 0.0 ? std::sqrt(variance / spread) / fit.scale() : 1.0;
  fit.inliers = std::move(inliers);
  return fit;
}

Similarity BestSample(const std::vector<OrientedMatch>& matches, double radius_m,
                      const ScaleRegistrationOptions& options) {
  std::mt19937 random(options.seed);
  Similarity best;
  for (int k = 0; k < options.iterations; ++k) {
    const auto a = static_cast<std::size_t>(random() % matches.size());
    const auto b = static_cast<std::size_t>(random() % matches.size());
    std::optional<Similarity> sample = OfTwo(matches[a], matches[b], options.max_scale);
    if (!sample || std::abs(WrapAngle(matches[a].Yaw() - std::arg(sample->factor))) > kKeypointAngleNoiseRad) {
      continue;
    }
    sample->inliers = InliersOf(matches, *sample, radius_m);
    if (sample->inliers.size() > best.inliers.size()) {
      best = std::move(*sample);
    }
  }
  return best;
}

std::optional<ScaleLink> Measure(const std::vector<BuildFrame>& frames, const RectM& floor, const FramePair& pair,
                                 const ScaleRegistrationOptions& options) {
  const Features& first = frames[static_cast<std::size_t>(pair.first)].features;
  const Features& second = frames[static_cast<std::size_t>(pair.second)].features;
  if (first.keypoints.empty() || second.keypoints.empty()) {
    return std::nullopt;
  }
  IndexOptions exact;
  exact.type = MatcherType::kBruteForce;
  const auto index = CreateDescriptorIndex(first.descriptors, exact);
  const std::vector<Match> nearest = FilterByRatio(FindNearest(*index, second.descriptors), options.max_ratio);
  const std::vector<OrientedMatch> matches = ToOrientedMatches(nearest, second.keypoints, first.keypoints);
  std::optional<Similarity> fit = FitSimilarity(matches, floor.width_m() * floor.height_m(), options);
  return fit ? std::optional(ScaleLink{pair.first, pair.second, std::move(*fit)}) : std::nullopt;
}

}  // namespace

void ScaleRegistrationOptions::Check() const {
  RequireOption(resolution_m > 0.0 && resolution_m < 1.0, "resolution_m must be between 0 and 1 m");
  RequireOption(inlier_radius_px > 0.0, "inlier_radius_px must be positive");
  RequireOption(max_ratio > 0.0F && max_ratio <= 1.0F, "max_ratio must be above 0 and at most 1");
  RequireOption(max_scale > 1.0, "max_scale must be above 1");
  RequireOption(iterations >= 1, "iterations must be at least 1");
  RequireOption(min_inliers >= 3, "min_inliers must be at least 3");
  RequireOption(max_p_wrong > 0.0 && max_p_wrong < 1.0, "max_p_wrong must be between 0 and 1");
  RequireOption(min_log_sigma > 0.0, "min_log_sigma must be positive");
  run.Check();
}

std::optional<Similarity> FitSimilarity(const std::vector<OrientedMatch>& matches, double area_m2,
                                        const ScaleRegistrationOptions& options) {
  const auto least = static_cast<std::size_t>(options.min_inliers);
  if (matches.size() < least) {
    return std::nullopt;
  }
  const double radius_m = options.inlier_radius_px * options.resolution_m;
  Similarity best = BestSample(matches, radius_m, options);
  for (int round = 0; round < kRefinements && best.inliers.size() >= least; ++round) {
    Similarity fit = FitTo(matches, best.inliers);
    fit.inliers = InliersOf(matches, fit, radius_m);
    best = std::move(fit);
  }
  RegistrationOptions chance;
  chance.inlier_radius_m = radius_m;
  if (best.inliers.size() < least ||
      Log10NfaOfPose(static_cast<int>(matches.size()), static_cast<int>(best.inliers.size()), {area_m2}, chance) >
          std::log10(options.max_p_wrong)) {
    return std::nullopt;
  }
  best.log_sigma = std::max(best.log_sigma, options.min_log_sigma);
  return best;
}

std::vector<ScaleLink> MeasureScales(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                     const std::vector<FramePair>& pairs, const ScaleRegistrationOptions& options) {
  options.Check();
  std::vector<std::optional<ScaleLink>> found(pairs.size());
  ProgressBar progress("heights", static_cast<std::int64_t>(pairs.size()), options.run.progress);
  ParallelFor(static_cast<int>(pairs.size()), options.run.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    found[index] = Measure(frames, floor_in_base[static_cast<std::size_t>(pairs[index].first)], pairs[index], options);
    progress.Advance();
  });
  std::vector<ScaleLink> links;
  for (std::optional<ScaleLink>& link : found) {
    if (link) {
      links.push_back(std::move(*link));
    }
  }
  return links;
}

}  // namespace floorloc
