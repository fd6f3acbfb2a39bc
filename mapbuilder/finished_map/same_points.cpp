// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/same_points.h"

#include <opencv2/core.hpp>

#include "core/vision/matching/guided_matcher.h"

namespace floorloc {
namespace {

// Twice the radius of a track (TrackOptions::radius_m at 0.7 mm per pixel), since poses may differ; its descriptor
// limits.
constexpr double kSamePointPx = 3.5;
constexpr double kMaxBinaryShare = 0.22;
constexpr double kMaxFloatShare = 0.55;

bool IsSimilar(const Match& match, const cv::Mat& descriptors) {
  if (descriptors.depth() == CV_8U) {
    return match.distance <= kMaxBinaryShare * 8.0 * descriptors.cols;
  }
  return match.distance <= kMaxFloatShare * cv::norm(descriptors.row(match.query), cv::NORM_L2);
}

}  // namespace

std::vector<Match> FindSamePoints(const MapKeypoints& a, const MapKeypoints& b, double resolution_m) {
  const double radius_m = kSamePointPx * resolution_m;
  const Pose2 b_from_a = b.MapFromOrigin().Between(a.MapFromOrigin());
  const GuidedMatcher matcher(b.keypoints, b.descriptors, 4.0 * radius_m);
  std::vector<bool> taken(b.size(), false);
  std::vector<Match> same;
  for (const Match& match :
       matcher.FindNearest({a.keypoints, a.descriptors}, {b_from_a, radius_m, kKeypointAngleNoiseRad, 1})) {
    if (!taken[static_cast<std::size_t>(match.train)] && IsSimilar(match, a.descriptors)) {
      taken[static_cast<std::size_t>(match.train)] = true;
      same.push_back(match);
    }
  }
  return same;
}

}  // namespace floorloc
