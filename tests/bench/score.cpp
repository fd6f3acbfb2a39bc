// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/score.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace floorloc {

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

Pose2 AlignMapToTruth(const std::vector<MapFrame>& frames, const Trajectory& ground_truth) {
  std::vector<Eigen::Vector2d> in_map, in_truth;
  Eigen::Vector2d map_mean = Eigen::Vector2d::Zero(), truth_mean = Eigen::Vector2d::Zero();
  for (const MapFrame& frame : frames) {
    if (const std::optional<Pose2> truth = InterpolatePose(ground_truth, frame.stamp_ns)) {
      in_map.push_back(frame.map_from_base.translation());
      in_truth.push_back(truth->translation());
      map_mean += in_map.back();
      truth_mean += in_truth.back();
    }
  }
  if (in_map.size() < 2) {
    throw std::invalid_argument("fewer than two frames of the map have a pose in the survey's groundtruth.tum");
  }
  map_mean /= static_cast<double>(in_map.size());
  truth_mean /= static_cast<double>(in_map.size());
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < in_map.size(); ++i) {
    const Eigen::Vector2d a = in_map[i] - map_mean, b = in_truth[i] - truth_mean;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw = std::atan2(sine, cosine);
  const Eigen::Vector2d translation = truth_mean - Pose2(0.0, 0.0, yaw) * map_mean;
  return Pose2(translation.x(), translation.y(), yaw);
}

Score ComputeScore(const std::vector<Fix>& fixes, const std::vector<Pose2>& truth, const Pose2& truth_from_map,
                   const Tolerance& tolerance) {
  assert(fixes.size() == truth.size());
  Score score;
  score.frames = static_cast<int>(fixes.size());
  std::vector<double> positions_m, yaws_rad, totals_ms;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    totals_ms.push_back(fixes[i].total_ms);
    if (fixes[i].map_from_base) {
      const Pose2 error = truth[i].Between(truth_from_map * *fixes[i].map_from_base);
      positions_m.push_back(error.translation().norm());
      yaws_rad.push_back(std::abs(error.yaw()));
      score.right += positions_m.back() <= tolerance.position_m && yaws_rad.back() <= tolerance.yaw_rad;
    }
  }
  score.localized = static_cast<int>(positions_m.size());
  score.position_median_m = Percentile(positions_m, 0.5);
  score.position_p99_m = Percentile(positions_m, 0.99);
  score.yaw_median_rad = Percentile(yaws_rad, 0.5);
  score.yaw_p99_rad = Percentile(yaws_rad, 0.99);
  score.total_median_ms = Percentile(totals_ms, 0.5);
  return score;
}

}  // namespace floorloc
