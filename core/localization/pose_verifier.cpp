// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_verifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

#include "core/localization/oriented_matches.h"
#include "core/registration/significance.h"

namespace floorloc {
namespace {

// How far a keypoint may be from where the hypothesis predicts it, before refinement, in inlier radii.
constexpr double kRadii = 3.0;
constexpr double kYawRadiusRad = 0.45;

// Share of pairs of different floor points that may count as alike.
constexpr double kAlikeShare = 0.01;

double DescriptorDistance(const cv::Mat& descriptors, int a, int b) {
  return cv::norm(descriptors.row(a), descriptors.row(b),
                  descriptors.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
}

}  // namespace

PoseVerifier::PoseVerifier(const MapKeypoints& map, const GuidedMatcher& matcher, double area_m2,
                           const RegistrationOptions& options)
    : map_(map), matcher_(matcher), options_(options) {
  MeasureChance(area_m2);
}

void PoseVerifier::MeasureChance(double area_m2) {
  const auto count = static_cast<std::uint32_t>(map_.size());
  if (count < 2) {
    return;
  }
  constexpr int kPairs = 20000;
  std::mt19937 random(options_.seed);
  std::vector<double> distances;
  for (int i = 0; i < kPairs; ++i) {
    const auto a = static_cast<int>(random() % count);
    const auto b = static_cast<int>(random() % count);
    if (a != b) {
      distances.push_back(DescriptorDistance(map_.descriptors, a, b));
    }
  }
  const auto quantile = distances.begin() + static_cast<std::ptrdiff_t>(kAlikeShare * kPairs);
  std::nth_element(distances.begin(), quantile, distances.end());
  max_distance_ = static_cast<float>(*quantile);
  const double per_m2 = count / std::max(area_m2, 1e-3);
  const double disc_m2 = std::numbers::pi * options_.inlier_radius_m * options_.inlier_radius_m;
  const double angle_share = kYawRadiusRad / std::numbers::pi;
  chance_ = std::min(0.5, per_m2 * disc_m2 * angle_share * kAlikeShare);
}

VerifiedPose PoseVerifier::Verify(const Features& features, const Pose2& map_from_base) const {
  VerifiedPose verified;
  std::vector<Match> alike =
      matcher_.FindNearest(features, {map_from_base, kRadii * options_.inlier_radius_m, kYawRadiusRad, 1});
  std::erase_if(alike, [&](const Match& match) { return match.distance > max_distance_; });
  verified.matches = ToOrientedMatches(alike, features.keypoints, map_.keypoints);
  verified.candidate = RefinePose(verified.matches, map_from_base, options_);
  verified.distance.assign(features.keypoints.size(), std::numeric_limits<float>::infinity());
  for (const int i : verified.candidate.inliers) {
    const Match& match = alike[static_cast<std::size_t>(i)];
    verified.distance[static_cast<std::size_t>(match.query)] = match.distance;
  }
  // The hypothesis came from pairs of keypoints, so as many were tried; two inliers are its own doing.
  const auto keypoints = static_cast<double>(features.keypoints.size());
  verified.candidate.log10_nfa =
      Log10Nfa(static_cast<int>(keypoints) - 2, static_cast<int>(verified.candidate.inliers.size()) - 2,
               std::max(chance_, 1e-6), std::max(1.0, 0.5 * keypoints * (keypoints - 1.0)));
  return verified;
}

}  // namespace floorloc
