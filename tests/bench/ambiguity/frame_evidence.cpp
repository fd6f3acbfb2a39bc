// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/frame_evidence.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/tracking/lattice_tracker.h"

namespace floorloc {
namespace {

constexpr double kAtPlaceM = 0.02;
constexpr double kMinProbability = 1e-9;  // as RegistrationOptions::min_p_wrong: no model is surer than this
// Weights of alternatives are shares among those that were found; what was not found is left a share of this.
constexpr double kNotFound = 1e-3;

double LogProbability(double p) { return std::log(std::max(p, kMinProbability)); }

bool WasCompared(const LatticeObservation& observation, const Eigen::Vector2i& multiples) {
  return std::any_of(observation.places.begin(), observation.places.end(),
                     [&](const LatticePlace& place) { return place.multiples == multiples; });
}

// All places on the map; of those that were not compared the likelihood ratio is 1, as its mean at wrong places.
FrameEvidence PlacesOf(const LatticeObservation& observation) {
  FrameEvidence evidence;
  evidence.log_elsewhere = LogProbability(observation.p_wrong);
  for (const LatticePlace& place : observation.places) {
    evidence.poses.push_back({place.map_from_base, LogLikelihoodOfPlace(place)});
  }
  const RectM& extent = observation.map_extent;
  const Eigen::Matrix2d& basis = observation.lattice.basis;
  const Pose2& pose = observation.map_from_base;
  const double reach_m = std::hypot(extent.width_m(), extent.height_m());
  const auto most = static_cast<int>(std::ceil(reach_m * basis.inverse().rowwise().norm().maxCoeff()));
  for (int i = -most; i <= most; ++i) {
    for (int k = -most; k <= most; ++k) {
      const Eigen::Vector2d t = pose.translation() + basis * Eigen::Vector2d(i, k);
      const Pose2 place(t.x(), t.y(), pose.yaw());
      if (extent.Contains(place * observation.view_center) && !WasCompared(observation, {i, k})) {
        evidence.poses.push_back({place, 0.0});
      }
    }
  }
  return evidence;
}

// log of the mean of the likelihoods of all but one.
double LogMeanOfOthers(const std::vector<LatticePlace>& places, const LatticePlace* one) {
  double largest = LogLikelihoodOfPlace(places.front());
  for (const LatticePlace& place : places) {
    largest = std::max(largest, LogLikelihoodOfPlace(place));
  }
  double sum = 0.0;
  for (const LatticePlace& place : places) {
    sum += &place == one ? 0.0 : std::exp(LogLikelihoodOfPlace(place) - largest);
  }
  return largest + std::log(sum / static_cast<double>(places.size() - 1));
}

}  // namespace

FrameEvidence EvidenceOf(const LocalizationResult& result) {
  if (result.status == LocalizationStatus::kLocalized) {
    return {{{result.map_from_base, 0.0}}, LogProbability(result.p_wrong)};
  }
  if (result.lattice) {
    return PlacesOf(*result.lattice);
  }
  FrameEvidence evidence;
  for (const PoseHypothesis& hypothesis : result.alternatives) {
    evidence.poses.push_back({hypothesis.target_from_source, LogProbability(hypothesis.weight)});
  }
  evidence.log_elsewhere = LogProbability(kNotFound);
  return evidence;
}

double LogLikelihoodOfPlace(const LatticePlace& place) {
  const double e = LatticeTrackerOptions().gain_sigma * place.expected_sigma;
  const double narrowing = 1.0 + e * e;
  const double gain = e * place.sigma / std::sqrt(narrowing);
  // 2 times the standard normal distribution at `gain` is erfc(-gain / sqrt 2).
  return 0.5 * gain * gain - 0.5 * std::log(narrowing) +
         std::log(std::max(1e-300, std::erfc(-gain / std::numbers::sqrt2)));
}

std::optional<double> BitsOfFrame(const LatticeObservation& observation, const Pose2& true_map_from_base) {
  const std::vector<LatticePlace>& places = observation.places;
  const auto right = std::find_if(places.begin(), places.end(), [&](const LatticePlace& place) {
    return true_map_from_base.Between(place.map_from_base).translation().norm() < kAtPlaceM;
  });
  if (right == places.end() || places.size() < 2) {
    return std::nullopt;
  }
  return (LogLikelihoodOfPlace(*right) - LogMeanOfOthers(places, &*right)) / std::numbers::ln2;
}

}  // namespace floorloc
