// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/pose_from_matches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>

#include "core/geometry/option_check.h"
#include "core/localization/oriented_matches.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

// Inliers of a similarity of scale 1; empty when there is none.
std::vector<Match> FilterByRansac(const std::vector<Match>& matches, const std::vector<OrientedMatch>& oriented,
                                  const PoseFromMatchesOptions& options) {
  if (matches.size() < 2) {
    return {};
  }
  std::vector<cv::Point2f> in_base, in_map;
  for (const OrientedMatch& match : oriented) {
    in_base.emplace_back(static_cast<float>(match.source_m.x()), static_cast<float>(match.source_m.y()));
    in_map.emplace_back(static_cast<float>(match.target_m.x()), static_cast<float>(match.target_m.y()));
  }
  std::vector<unsigned char> agrees;
  const cv::Mat similarity =
      cv::estimateAffinePartial2D(in_base, in_map, agrees, cv::RANSAC, options.inlier_radius_m, 2000, 0.99, 0);
  if (similarity.empty() ||
      std::abs(std::hypot(similarity.at<double>(0, 0), similarity.at<double>(1, 0)) - 1.0) > options.max_scale_error) {
    return {};
  }
  std::vector<Match> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (agrees[i] != 0) {
      kept.push_back(matches[i]);
    }
  }
  return kept;
}

std::optional<Pose2> FitLeastSquares(const std::vector<OrientedMatch>& matches) {
  std::vector<int> all(matches.size());
  std::iota(all.begin(), all.end(), 0);
  return FitRigid(matches, all);
}

Pose2 FitWeightedMean(const std::vector<OrientedMatch>& oriented, const std::vector<Match>& matches) {
  Eigen::Vector2d source = Eigen::Vector2d::Zero();
  Eigen::Vector2d target = Eigen::Vector2d::Zero();
  double turn = 0.0;
  double mass = 0.0;
  for (std::size_t i = 0; i < oriented.size(); ++i) {
    constexpr float kSmallestDistance = 1e-3F;
    const double weight = 1.0 / std::max(matches[i].distance, kSmallestDistance);
    source += weight * oriented[i].source_m;
    target += weight * oriented[i].target_m;
    turn += weight * WrapAngle(oriented[i].Yaw() - oriented.front().Yaw());  // avoids wrap-around
    mass += weight;
  }
  const double yaw = oriented.front().Yaw() + turn / mass;
  const Eigen::Vector2d position = target / mass - Pose2(0.0, 0.0, yaw) * Eigen::Vector2d(source / mass);
  return {position.x(), position.y(), yaw};
}

}  // namespace

void PoseFromMatchesOptions::Check() const {
  RequireOption(max_ratio > 0.0 && max_ratio <= 1.0, "max_ratio must be above 0 and at most 1");
  RequireOption(inlier_radius_m > 0.0, "inlier_radius_m must be positive");
  RequireOption(max_scale_error > 0.0 && max_scale_error < 1.0, "max_scale_error must be between 0 and 1");
}

MatchedPose ComputePose(const std::vector<Match>& neighbours, const Features& frame, const Features& map,
                        MatchFilter filter, const PoseFromMatchesOptions& options) {
  options.Check();
  MatchedPose result;
  const bool ratio = filter == MatchFilter::kRatio || filter == MatchFilter::kRatioRansac;
  result.matches = ratio ? FilterByRatio(neighbours, static_cast<float>(options.max_ratio)) : neighbours;
  std::vector<OrientedMatch> oriented = ToOrientedMatches(result.matches, frame.keypoints, map.keypoints);
  if (filter == MatchFilter::kRansac || filter == MatchFilter::kRatioRansac) {
    result.matches = FilterByRansac(result.matches, oriented, options);
    oriented = ToOrientedMatches(result.matches, frame.keypoints, map.keypoints);
  }
  if (oriented.size() < 2) {
    return result;
  }
  result.map_from_base =
      options.fit == PoseFit::kLeastSquares ? FitLeastSquares(oriented) : FitWeightedMean(oriented, result.matches);
  if (result.map_from_base) {
    result.inliers = static_cast<int>(FindInliers(oriented, *result.map_from_base, options.inlier_radius_m).size());
  }
  return result;
}

}  // namespace floorloc
