// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/fix_score.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace floorloc {
namespace {

// Signed errors of the localized frames.
struct Errors {
  std::vector<double> x_m, y_m, yaw_rad;
  std::vector<double> position_m, abs_yaw_rad;

  void Add(const Pose2& truth, const Pose2& estimate) {
    const Eigen::Vector2d offset = estimate.translation() - truth.translation();
    x_m.push_back(offset.x());
    y_m.push_back(offset.y());
    yaw_rad.push_back(WrapAngle(estimate.yaw() - truth.yaw()));
    position_m.push_back(offset.norm());
    abs_yaw_rad.push_back(std::abs(yaw_rad.back()));
  }
};

double RootMeanSquare(const std::vector<double>& values, double around) {
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - around) * (value - around);
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void FillErrors(const Errors& errors, Score* score) {
  score->position_mean_m = Mean(errors.position_m);
  score->position_median_m = Percentile(errors.position_m, 0.5);
  score->position_p99_m = Percentile(errors.position_m, 0.99);
  score->yaw_mean_rad = Mean(errors.abs_yaw_rad);
  score->yaw_median_rad = Percentile(errors.abs_yaw_rad, 0.5);
  score->yaw_p99_rad = Percentile(errors.abs_yaw_rad, 0.99);
  score->accuracy = {RootMeanSquare(errors.x_m, 0.0), RootMeanSquare(errors.y_m, 0.0),
                     RootMeanSquare(errors.yaw_rad, 0.0)};
  score->precision = {RootMeanSquare(errors.x_m, Mean(errors.x_m)), RootMeanSquare(errors.y_m, Mean(errors.y_m)),
                      RootMeanSquare(errors.yaw_rad, Mean(errors.yaw_rad))};
}

}  // namespace

double Deviation::position_m() const { return std::hypot(x_m, y_m); }

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double Mean(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Score ComputeScore(const std::vector<Fix>& fixes, const std::vector<Pose2>& truth, const Pose2& truth_from_map,
                   const Tolerance& tolerance) {
  assert(fixes.size() == truth.size());
  Score score;
  score.frames = static_cast<int>(fixes.size());
  Errors errors;
  std::vector<double> totals_ms;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    totals_ms.push_back(fixes[i].total_ms);
    if (fixes[i].map_from_base) {
      errors.Add(truth[i], truth_from_map * *fixes[i].map_from_base);
      score.right += errors.position_m.back() <= tolerance.position_m && errors.abs_yaw_rad.back() <= tolerance.yaw_rad;
    }
  }
  score.localized = static_cast<int>(errors.position_m.size());
  FillErrors(errors, &score);
  score.total_median_ms = Percentile(totals_ms, 0.5);
  return score;
}

}  // namespace floorloc
