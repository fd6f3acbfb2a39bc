// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_verifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

#include "core/geometry/option_check.h"
#include "core/localization/oriented_matches.h"
#include "core/registration/significance.h"

namespace floorloc {
namespace {

constexpr int kPairs = 20000;

double DescriptorDistance(const cv::Mat& descriptors, int a, int b) {
  return cv::norm(descriptors.row(a), descriptors.row(b),
                  descriptors.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
}

// The distance that `rank` others are below; 0 when there are too few.
double OrderStatistic(std::vector<double> distances, double rank) {
  if (rank < 1.0 || rank >= static_cast<double>(distances.size())) {
    return 0.0;
  }
  const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(distances.begin(), nth, distances.end());
  return *nth;
}

}  // namespace

void VerificationOptions::Check() const {
  RequireOption(search_radii >= 1 && search_radii < 100, "search_radii must be 1 to 100");
  RequireOption(yaw_radius_rad > 0 && yaw_radius_rad < 4, "yaw_radius_rad must be between 0 and 4");
  RequireOption(alike_share > 0 && alike_share < 1, "alike_share must be between 0 and 1");
  RequireOption(min_neighbour_radii >= 1 && min_neighbour_radii < max_neighbour_radii,
                "min_neighbour_radii must be at least 1 and below max_neighbour_radii");
  RequireOption(max_neighbour_radii < 1000, "max_neighbour_radii must be below 1000");
  RequireOption(copies_sigma >= 0, "copies_sigma must not be negative");
  RequireOption(min_chance > 0 && min_chance <= max_chance, "min_chance must be above 0 and at most max_chance");
  RequireOption(max_chance < 1, "max_chance must be below 1");
}

PoseVerifier::PoseVerifier(const FloorMap& map, const GuidedMatcher& matcher, const RegistrationOptions& registration,
                           const VerificationOptions& options, VerifiedBy by)
    : map_(map.keypoints),
      upright_(by == VerifiedBy::kUpright),
      descriptors_(upright_ ? map_.upright : map_.descriptors),
      matcher_(matcher),
      registration_(registration),
      options_(options) {
  MeasureChance(map.info.area_m2);
}

std::vector<double> PoseVerifier::DistancesOfAnyPairs(std::mt19937* random) const {
  const auto count = static_cast<std::uint32_t>(map_.size());
  std::vector<double> distances;
  for (int i = 0; i < kPairs; ++i) {
    const auto a = static_cast<int>((*random)() % count);
    const auto b = static_cast<int>((*random)() % count);
    if (a != b) {
      distances.push_back(DescriptorDistance(descriptors_, a, b));
    }
  }
  return distances;
}

std::vector<double> PoseVerifier::DistancesOfNeighbours(std::mt19937* random) const {
  const double min_m = options_.min_neighbour_radii * registration_.inlier_radius_m;
  const double max_m = options_.max_neighbour_radii * registration_.inlier_radius_m;
  std::vector<double> distances;
  for (int i = 0; i < kPairs; ++i) {
    const std::size_t a = (*random)() % map_.size();
    const Keypoint& keypoint = map_.keypoints[a];
    std::vector<int> around = matcher_.FindWithin(keypoint, max_m);
    std::erase_if(around, [&](int b) {
      return (map_.keypoints[static_cast<std::size_t>(b)].Position() - keypoint.Position()).norm() < min_m;
    });
    if (!around.empty()) {
      const int b = around[(*random)() % around.size()];
      distances.push_back(DescriptorDistance(descriptors_, static_cast<int>(a), b));
    }
  }
  return distances;
}

// max_distance_ is an order statistic of the distances between random pairs of keypoints, as few different floor points
// are similar. Where the floor repeats itself such pairs include copies of one point: every n-th pair on tiles with n
// keypoints. There pairs of neighbours are used, which are never copies.
void PoseVerifier::MeasureChance(double area_m2) {
  if (map_.size() < 2) {
    return;
  }
  std::mt19937 random(registration_.seed);
  const std::vector<double> any = DistancesOfAnyPairs(&random);
  const std::vector<double> neighbours = DistancesOfNeighbours(&random);
  const double rank = options_.alike_share * kPairs;
  const double by_neighbours =
      OrderStatistic(neighbours, options_.alike_share * static_cast<double>(neighbours.size()));
  const auto alike =
      static_cast<double>(std::count_if(any.begin(), any.end(), [&](double d) { return d < by_neighbours; }));
  const bool copies = alike > rank + options_.copies_sigma * std::sqrt(2.0 * rank);
  max_distance_ = static_cast<float>(copies ? by_neighbours : OrderStatistic(any, rank));
  // Copies raise the probability of a match by chance: a wrong pose predicts a keypoint where a copy of it lies.
  const double alike_share = copies ? alike / kPairs : options_.alike_share;
  const double per_m2 = static_cast<double>(map_.size()) / std::max(area_m2, 1e-3);
  const double disc_m2 = std::numbers::pi * registration_.inlier_radius_m * registration_.inlier_radius_m;
  const double angle_share = upright_ ? 1.0 : options_.yaw_radius_rad / std::numbers::pi;
  chance_ = std::min(options_.max_chance, per_m2 * disc_m2 * angle_share * alike_share);
}

VerifiedPose PoseVerifier::Verify(const Features& features, const Pose2& map_from_base) const {
  VerifiedPose verified;
  std::vector<Match> alike = matcher_.FindNearest(
      features,
      {map_from_base, options_.search_radii * registration_.inlier_radius_m, options_.yaw_radius_rad, 1, upright_});
  std::erase_if(alike, [&](const Match& match) { return match.distance > max_distance_; });
  verified.matches = ToOrientedMatches(alike, features.keypoints, map_.keypoints);
  verified.candidate = RefinePose(verified.matches, map_from_base, registration_);
  verified.distance.assign(features.keypoints.size(), std::numeric_limits<float>::infinity());
  for (const int i : verified.candidate.inliers) {
    const Match& match = alike[static_cast<std::size_t>(i)];
    verified.distance[static_cast<std::size_t>(match.query)] = match.distance;
  }
  // Number of trials: pairs of keypoints, which propose the poses. The two inliers of such a pair fit by construction.
  const auto keypoints = static_cast<double>(features.keypoints.size());
  verified.candidate.log10_nfa =
      Log10Nfa(static_cast<int>(keypoints) - 2, static_cast<int>(verified.candidate.inliers.size()) - 2,
               std::max(chance_, options_.min_chance), std::max(1.0, 0.5 * keypoints * (keypoints - 1.0)));
  return verified;
}

}  // namespace floorloc
