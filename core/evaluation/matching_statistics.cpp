// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/matching_statistics.h"

#include <algorithm>
#include <cassert>

namespace floorloc {
namespace {

// Points sorted by x, so that only a narrow strip is searched for those within a radius.
class SortedPoints {
 public:
  explicit SortedPoints(const std::vector<Keypoint>& keypoints) {
    for (const Keypoint& k : keypoints) {
      points_.push_back(k.Position());
    }
    std::sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  }

  bool AnyWithin(const Eigen::Vector2d& centre, double radius_m) const {
    auto point = std::lower_bound(points_.begin(), points_.end(), centre.x() - radius_m,
                                  [](const Eigen::Vector2d& p, double x) { return p.x() < x; });
    for (; point != points_.end() && point->x() <= centre.x() + radius_m; ++point) {
      if ((*point - centre).norm() <= radius_m) {
        return true;
      }
    }
    return false;
  }

 private:
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace

double Repeatability(const std::vector<Keypoint>& query, const std::vector<Keypoint>& target,
                     const Pose2& target_from_query, double radius_m) {
  assert(radius_m > 0.0);
  if (query.empty()) {
    return 0.0;
  }
  const SortedPoints points(target);
  const auto found = std::count_if(query.begin(), query.end(), [&](const Keypoint& k) {
    return points.AnyWithin(target_from_query * k.Position(), radius_m);
  });
  return static_cast<double>(found) / static_cast<double>(query.size());
}

std::vector<bool> FindCorrectMatches(const std::vector<Match>& matches, const std::vector<Keypoint>& query,
                                     const std::vector<Keypoint>& target, const Pose2& target_from_query,
                                     double radius_m) {
  std::vector<bool> right;
  for (const Match& match : matches) {
    const Eigen::Vector2d expected = target_from_query * query[static_cast<std::size_t>(match.query)].Position();
    right.push_back((target[static_cast<std::size_t>(match.train)].Position() - expected).norm() <= radius_m);
  }
  return right;
}

double MatchingScore(const std::vector<bool>& right_matches, std::size_t query_keypoints) {
  if (query_keypoints == 0) {
    return 0.0;
  }
  const auto right = std::count(right_matches.begin(), right_matches.end(), true);
  return static_cast<double>(right) / static_cast<double>(query_keypoints);
}

}  // namespace floorloc
