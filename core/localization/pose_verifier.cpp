// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_verifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>

#include "core/localization/oriented_matches.h"
#include "core/registration/significance.h"

namespace floorloc {
namespace {

double DescriptorDistance(const cv::Mat& descriptors, int a, int b) {
  return cv::norm(descriptors.row(a), descriptors.row(b),
                  descriptors.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
}

}  // namespace

void VerificationOptions::Check() const {
  const auto require = [](bool ok, const char* message) {
    if (!ok) {
      throw std::invalid_argument(message);
    }
  };
  require(search_radii >= 1 && search_radii < 100, "search_radii must be 1 to 100");
  require(yaw_radius_rad > 0 && yaw_radius_rad < 4, "yaw_radius_rad must be between 0 and 4");
  require(alike_share > 0 && alike_share < 1, "alike_share must be between 0 and 1");
  require(min_chance > 0 && min_chance <= max_chance, "min_chance must be above 0 and at most max_chance");
  require(max_chance < 1, "max_chance must be below 1");
}

PoseVerifier::PoseVerifier(const FloorMap& map, const GuidedMatcher& matcher, const RegistrationOptions& registration,
                           const VerificationOptions& options)
    : map_(map.keypoints), matcher_(matcher), registration_(registration), options_(options) {
  MeasureChance(map.info.area_m2);
}

void PoseVerifier::MeasureChance(double area_m2) {
  const auto count = static_cast<std::uint32_t>(map_.size());
  if (count < 2) {
    return;
  }
  constexpr int kPairs = 20000;
  std::mt19937 random(registration_.seed);
  std::vector<double> distances;
  for (int i = 0; i < kPairs; ++i) {
    const auto a = static_cast<int>(random() % count);
    const auto b = static_cast<int>(random() % count);
    if (a != b) {
      distances.push_back(DescriptorDistance(map_.descriptors, a, b));
    }
  }
  const auto quantile = distances.begin() + static_cast<std::ptrdiff_t>(options_.alike_share * kPairs);
  std::nth_element(distances.begin(), quantile, distances.end());
  max_distance_ = static_cast<float>(*quantile);
  const double per_m2 = count / std::max(area_m2, 1e-3);
  const double disc_m2 = std::numbers::pi * registration_.inlier_radius_m * registration_.inlier_radius_m;
  const double angle_share = options_.yaw_radius_rad / std::numbers::pi;
  chance_ = std::min(options_.max_chance, per_m2 * disc_m2 * angle_share * options_.alike_share);
}

VerifiedPose PoseVerifier::Verify(const Features& features, const Pose2& map_from_base) const {
  VerifiedPose verified;
  std::vector<Match> alike = matcher_.FindNearest(
      features, {map_from_base, options_.search_radii * registration_.inlier_radius_m, options_.yaw_radius_rad, 1});
  std::erase_if(alike, [&](const Match& match) { return match.distance > max_distance_; });
  verified.matches = ToOrientedMatches(alike, features.keypoints, map_.keypoints);
  verified.candidate = RefinePose(verified.matches, map_from_base, registration_);
  verified.distance.assign(features.keypoints.size(), std::numeric_limits<float>::infinity());
  for (const int i : verified.candidate.inliers) {
    const Match& match = alike[static_cast<std::size_t>(i)];
    verified.distance[static_cast<std::size_t>(match.query)] = match.distance;
  }
  // The hypothesis came from pairs of keypoints, so as many were tried; two inliers are its own doing.
  const auto keypoints = static_cast<double>(features.keypoints.size());
  verified.candidate.log10_nfa =
      Log10Nfa(static_cast<int>(keypoints) - 2, static_cast<int>(verified.candidate.inliers.size()) - 2,
               std::max(chance_, options_.min_chance), std::max(1.0, 0.5 * keypoints * (keypoints - 1.0)));
  return verified;
}

}  // namespace floorloc
