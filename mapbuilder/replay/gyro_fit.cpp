// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/gyro_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// A turn by fixes is good to a tenth of it: others are of wrong fixes, or of a vehicle that is carried away.
constexpr double kInlierRad = 0.004;
constexpr std::size_t kHypotheses = 500;

struct Turn {
  double seconds = 0.0;
  double by_fixes_rad = 0.0;
  double by_gyro_rad = 0.0;
};

// A reading holds since the one before it.
double GyroBetween(const std::vector<ImuSample>& imu, std::int64_t from_ns, std::int64_t to_ns) {
  auto it = std::upper_bound(imu.begin(), imu.end(), from_ns,
                             [](std::int64_t ns, const ImuSample& sample) { return ns < sample.stamp_ns; });
  double turn_rad = 0.0;
  std::int64_t since_ns = from_ns;
  for (; it != imu.end() && since_ns < to_ns; ++it) {
    const std::int64_t until_ns = std::min(to_ns, it->stamp_ns);
    turn_rad += it->angular_velocity.z() * ToSeconds(until_ns - since_ns);
    since_ns = until_ns;
  }
  return turn_rad;
}

std::vector<Turn> TurnsOf(const std::vector<ImuSample>& imu, const std::vector<FusedFrame>& frames, double max_pair_s) {
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const LocalizedFrame& before = frames[i - 1].localized;
    const LocalizedFrame& after = frames[i].localized;
    const double seconds = ToSeconds(after.frame.stamp_ns - before.frame.stamp_ns);
    if (before.result.status == LocalizationStatus::kLocalized &&
        after.result.status == LocalizationStatus::kLocalized && seconds <= max_pair_s) {
      turns.push_back({seconds, before.result.map_from_base.Between(after.result.map_from_base).yaw(),
                       GyroBetween(imu, before.frame.stamp_ns, after.frame.stamp_ns)});
    }
  }
  return turns;
}

// fixes = factors(0) * gyro + factors(1) * seconds
using Factors = Eigen::Vector2d;

bool Explains(const Factors& factors, const Turn& turn) {
  return std::abs(turn.by_fixes_rad - factors(0) * turn.by_gyro_rad - factors(1) * turn.seconds) < kInlierRad;
}

// The factors of two turns that explain the most (RANSAC, with evenly spread samples).
Factors MostAgreed(const std::vector<Turn>& turns) {
  Factors best(1.0, 0.0);
  std::ptrdiff_t most = 0;
  const std::size_t step = 1 + turns.size() / kHypotheses;
  for (std::size_t i = 0; i < turns.size(); i += step) {
    const Turn& a = turns[i];
    const Turn& b = turns[(i + turns.size() / 3 + 1) % turns.size()];
    const Eigen::Matrix2d rows = (Eigen::Matrix2d() << a.by_gyro_rad, a.seconds, b.by_gyro_rad, b.seconds).finished();
    const Factors factors = rows.inverse() * Eigen::Vector2d(a.by_fixes_rad, b.by_fixes_rad);
    const auto explained =
        std::count_if(turns.begin(), turns.end(), [&](const Turn& turn) { return Explains(factors, turn); });
    if (explained > most) {
      most = explained;
      best = factors;
    }
  }
  return best;
}

Factors FitInliers(const std::vector<Turn>& turns, const Factors& start) {
  Eigen::Matrix2d information = 1e-12 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (const Turn& turn : turns) {
    if (Explains(start, turn)) {
      const Eigen::Vector2d row(turn.by_gyro_rad, turn.seconds);
      information += row * row.transpose();
      pull += turn.by_fixes_rad * row;
    }
  }
  return information.inverse() * pull;
}

}  // namespace

GyroFit FitGyro(const std::vector<ImuSample>& imu, const std::vector<FusedFrame>& frames, double max_pair_s) {
  GyroFit fit;
  const std::vector<Turn> turns = TurnsOf(imu, frames, max_pair_s);
  const Factors factors = FitInliers(turns, MostAgreed(turns));
  fit.scale = factors(0);
  fit.bias_rad_s = factors(0) != 0.0 ? -factors(1) / factors(0) : 0.0;
  for (const Turn& turn : turns) {
    fit.turned_rad += std::abs(turn.by_fixes_rad);
  }
  return fit;
}

}  // namespace floorloc
