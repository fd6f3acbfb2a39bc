// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pair_selection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "core/geometry/option_check.h"
#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

// Odometry error allowed between consecutive frames: a share of the motion plus a constant.
constexpr double kOdometryShare = 0.3;
constexpr double kOdometryRadiusM = 0.03;
constexpr double kOdometryYawRad = 0.1;

using SpatialHash = std::unordered_map<std::int64_t, std::vector<int>>;

void VisitNeighbours(const SpatialHash& hash, std::int64_t x, std::int64_t y, const std::function<void(int)>& visit) {
  for (std::int64_t dx = -1; dx <= 1; ++dx) {
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      const auto cell = hash.find(CellKey(x + dx, y + dy));
      if (cell != hash.end()) {
        std::for_each(cell->second.begin(), cell->second.end(), visit);
      }
    }
  }
}

}  // namespace

std::vector<FramePair> SelectConsecutivePairs(const std::vector<BuildFrame>& frames) {
  std::vector<FramePair> pairs;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    if (frames[i].survey != frames[i + 1].survey) {
      continue;
    }
    FramePair pair;
    pair.first = static_cast<int>(i);
    pair.second = static_cast<int>(i + 1);
    if (frames[i].odom_from_base && frames[i + 1].odom_from_base && !frames[i + 1].odometry_breaks) {
      const Pose2 motion = frames[i].odom_from_base->Between(*frames[i + 1].odom_from_base);
      pair.first_from_second = motion;
      pair.radius_m = kOdometryRadiusM + kOdometryShare * motion.translation().norm();
      pair.yaw_radius_rad = kOdometryYawRad + kOdometryShare * std::abs(motion.yaw());
    }
    pairs.push_back(pair);
  }
  return pairs;
}

double OverlapShare(const RectM& first, const RectM& second, const Pose2& first_from_second) {
  constexpr int kSteps = 8;
  int inside = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector2d p(second.x_min + second.width_m() * (i + 0.5) / kSteps,
                              second.y_min + second.height_m() * (j + 0.5) / kSteps);
      inside += first.Contains(first_from_second * p) ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kSteps * kSteps);
}

void NearbyOptions::Check() const {
  RequireOption(min_overlap > 0.0 && min_overlap <= 1.0, "min_overlap must be above 0 and at most 1");
  RequireOption(radius_m >= 0.0, "radius_m must not be negative");
  RequireOption(yaw_radius_rad >= 0.0, "yaw_radius_rad must not be negative");
  RequireOption(first_new >= 0, "first_new must be 0 or more");
}

std::vector<FramePair> SelectNearbyPairs(const std::vector<std::optional<Pose2>>& map_from_base,
                                         const std::vector<RectM>& floor_in_base, const NearbyOptions& options) {
  options.Check();
  double cell_m = 1e-3;
  for (const RectM& r : floor_in_base) {
    cell_m = std::max(cell_m, std::hypot(r.width_m(), r.height_m()));
  }
  SpatialHash hash;
  std::vector<FramePair> pairs;
  for (std::size_t i = 0; i < map_from_base.size(); ++i) {
    if (!map_from_base[i]) {
      continue;
    }
    const Eigen::Vector2d center = *map_from_base[i] * floor_in_base[i].Center();
    const auto x = static_cast<std::int64_t>(std::floor(center.x() / cell_m));
    const auto y = static_cast<std::int64_t>(std::floor(center.y() / cell_m));
    const int second = static_cast<int>(i);
    if (second >= options.first_new) {
      VisitNeighbours(hash, x, y, [&](int first) {
        const auto f = static_cast<std::size_t>(first);
        const Pose2 motion = map_from_base[f]->Between(*map_from_base[i]);
        if (OverlapShare(floor_in_base[f], floor_in_base[i], motion) >= options.min_overlap) {
          pairs.push_back({first, second, motion, options.radius_m, options.yaw_radius_rad});
        }
      });
    }
    hash[CellKey(x, y)].push_back(second);
  }
  return pairs;
}

}  // namespace floorloc
