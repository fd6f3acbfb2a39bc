// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/gyro_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// A turn by fixes is good to a tenth of it: others are of wrong fixes, or of a vehicle that is carried away.
constexpr double kInlierRad = 0.004;
constexpr std::size_t kHypotheses = 500;

// fixes = factors(0) * gyro + factors(1) * seconds
using Factors = Eigen::Vector2d;

bool Explains(const Factors& factors, const GyroTurn& turn) {
  return std::abs(turn.by_fixes_rad - factors(0) * turn.by_gyro_rad - factors(1) * turn.seconds) < kInlierRad;
}

// The factors of two turns that explain the most (RANSAC, with evenly spread samples).
Factors MostAgreed(const std::vector<GyroTurn>& turns) {
  Factors best(1.0, 0.0);
  std::ptrdiff_t most = 0;
  const std::size_t step = 1 + turns.size() / kHypotheses;
  for (std::size_t i = 0; i < turns.size(); i += step) {
    const GyroTurn& a = turns[i];
    const GyroTurn& b = turns[(i + turns.size() / 3 + 1) % turns.size()];
    const Eigen::Matrix2d rows = (Eigen::Matrix2d() << a.by_gyro_rad, a.seconds, b.by_gyro_rad, b.seconds).finished();
    const Factors factors = rows.inverse() * Eigen::Vector2d(a.by_fixes_rad, b.by_fixes_rad);
    const auto explained =
        std::count_if(turns.begin(), turns.end(), [&](const GyroTurn& turn) { return Explains(factors, turn); });
    if (explained > most) {
      most = explained;
      best = factors;
    }
  }
  return best;
}

Factors FitInliers(const std::vector<GyroTurn>& turns, const Factors& start) {
  Eigen::Matrix2d information = 1e-12 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (const GyroTurn& turn : turns) {
    if (Explains(start, turn)) {
      const Eigen::Vector2d row(turn.by_gyro_rad, turn.seconds);
      information += row * row.transpose();
      pull += turn.by_fixes_rad * row;
    }
  }
  return information.inverse() * pull;
}

}  // namespace

GyroFit FitGyro(const std::vector<GyroTurn>& turns) {
  GyroFit fit;
  const Factors factors = FitInliers(turns, MostAgreed(turns));
  fit.scale = factors(0);
  fit.bias_rad_s = factors(0) != 0.0 ? -factors(1) / factors(0) : 0.0;
  for (const GyroTurn& turn : turns) {
    fit.turned_rad += std::abs(turn.by_fixes_rad);
  }
  return fit;
}

}  // namespace floorloc
