// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/markers/marker_positions.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/pose2.h"

namespace floorloc {
namespace {

// Smaller residuals may come from inaccurate surveying of the markers.
constexpr double kMinContradictionM = 0.01;
constexpr double kMaxMedians = 5.0;

// Each position is paired with this many following ones, which bounds the time for hundreds of markers.
constexpr std::size_t kPartners = 25;

// The motion that maps midpoint and direction of a pair of found positions to those of the expected ones.
Pose2 MotionOfPair(const MarkerPosition& a, const MarkerPosition& b) {
  const Eigen::Vector2d found = b.found_m - a.found_m;
  const Eigen::Vector2d expected = b.expected_m - a.expected_m;
  const double yaw = std::atan2(expected.y(), expected.x()) - std::atan2(found.y(), found.x());
  const Pose2 turn(0.0, 0.0, yaw);
  const Eigen::Vector2d shift =
      0.5 * (a.expected_m + b.expected_m) - turn * Eigen::Vector2d(0.5 * (a.found_m + b.found_m));
  return {shift.x(), shift.y(), yaw};
}

std::vector<double> ResidualsUnder(const Pose2& motion, const std::vector<MarkerPosition>& positions) {
  std::vector<double> residuals;
  for (const MarkerPosition& position : positions) {
    residuals.push_back((motion * position.found_m - position.expected_m).norm());
  }
  return residuals;
}

// Median; the lower of the two middle values for an even number.
double LowMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<double> RobustResiduals(const std::vector<MarkerPosition>& positions) {
  assert(positions.size() >= 2);
  std::vector<double> best;
  double best_score = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(positions.size(), i + 1 + kPartners); ++j) {
      std::vector<double> residuals = ResidualsUnder(MotionOfPair(positions[i], positions[j]), positions);
      std::vector<double> sorted = residuals;
      std::sort(sorted.begin(), sorted.end());
      const double score = sorted[std::max<std::size_t>(1, positions.size() / 2)];
      if (score < best_score) {
        best_score = score;
        best = std::move(residuals);
      }
    }
  }
  return best;
}

std::vector<std::size_t> FindContradicting(const std::vector<MarkerPosition>& positions) {
  std::vector<std::size_t> contradicting;
  if (positions.size() < 3) {
    return contradicting;
  }
  const std::vector<double> residuals = RobustResiduals(positions);
  const double limit = std::max(kMinContradictionM, kMaxMedians * LowMedian(residuals));
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals[i] > limit) {
      contradicting.push_back(i);
    }
  }
  return contradicting;
}

int CommonQuarterTurn(const std::vector<double>& yaw_errors_rad, double tolerance_rad) {
  for (const int turns : {-1, 1, 2}) {
    const auto is_off = [&](double error_rad) {
      return std::abs(WrapAngle(error_rad - turns * 0.5 * std::numbers::pi)) <= tolerance_rad;
    };
    if (yaw_errors_rad.size() >= 2 && std::all_of(yaw_errors_rad.begin(), yaw_errors_rad.end(), is_off)) {
      return turns;
    }
  }
  return 0;
}

}  // namespace floorloc
