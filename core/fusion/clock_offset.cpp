// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace floorloc {
namespace {

constexpr std::size_t kMaxFixes = 32;
constexpr std::int64_t kSearchEveryNs = 1'000'000'000;
constexpr std::int64_t kSameNs = 30'000'000;    // two searches in a row must agree to this
constexpr std::int64_t kRefineNs = 60'000'000;  // a smaller change of an offset is the same one, known better ...
constexpr double kRefineShare = 0.2;            // ... for which a share of the gain suffices
constexpr double kMaxCost = 9.0;  // of one residual: three sigma; limits what a wrong fix or a slip can say

struct IntervalPair {
  Pose2 by_fixes;
  Pose2 by_wheels;
};

// Least squares factor from wheels to fixes, within the bounds of what wheels do wrong.
double FitFactor(double said_said, double said_true, double bound) {
  return said_said > 1e-9 ? std::clamp(said_true / said_said, 1.0 - bound, 1.0 + bound) : 1.0;
}

// What the wheels' distances and turns must be multiplied with.
struct Factors {
  double scale = 1.0;
  double yaw_scale = 1.0;
};

Factors FitFactors(const std::vector<IntervalPair>& pairs, const OdometryMonitorOptions& options) {
  double m_said = 0.0, m_true = 0.0, rad_said = 0.0, rad_true = 0.0;
  for (const IntervalPair& pair : pairs) {
    m_said += pair.by_wheels.translation().squaredNorm();
    m_true += pair.by_wheels.translation().dot(pair.by_fixes.translation());
    rad_said += pair.by_wheels.yaw() * pair.by_wheels.yaw();
    rad_true += pair.by_wheels.yaw() * pair.by_fixes.yaw();
  }
  return {FitFactor(m_said, m_true, options.tolerance_scale),
          FitFactor(rad_said, rad_true, options.tolerance_yaw_scale)};
}

double Cost(double residual, double sigma) { return std::min(residual * residual / (sigma * sigma), kMaxCost); }

}  // namespace

void ClockOffset::Clear() {
  fixes_.clear();
  candidate_ns_.reset();
  last_search_ns_ = 0;
}

ClockOffset::Misfit ClockOffset::MisfitAt(std::int64_t offset_ns, const WheelHypotheses& wheels) const {
  // The same intervals for every shift: those that none takes beyond the wheels' newest message.
  const std::int64_t last_ns = wheels.newest_ns() - ToNanoseconds(options_.max_offset_s);
  std::vector<IntervalPair> pairs;
  for (std::size_t i = 1; i < fixes_.size() && fixes_[i].stamp_ns <= last_ns; ++i) {
    if (const auto said = wheels.Between({}, fixes_[i - 1].stamp_ns + offset_ns, fixes_[i].stamp_ns + offset_ns, 0.0)) {
      pairs.push_back({fixes_[i - 1].map_from_base.Between(fixes_[i].map_from_base), said->motion});
    }
  }
  const Factors factors = FitFactors(pairs, options_);
  Misfit misfit;
  for (const IntervalPair& pair : pairs) {
    const double m = pair.by_fixes.translation().norm();
    const double rad = std::abs(pair.by_fixes.yaw());
    const Eigen::Vector2d off = factors.scale * pair.by_wheels.translation() - pair.by_fixes.translation();
    const double off_rad = WrapAngle(factors.yaw_scale * pair.by_wheels.yaw() - pair.by_fixes.yaw());
    misfit.total += Cost(off.norm(), options_.clock_sigma_m + options_.clock_sigma_share * m) +
                    Cost(off_rad, options_.clock_sigma_rad + options_.clock_sigma_share * rad);
    misfit.intervals += 1;
  }
  misfit.per_interval = misfit.total / std::max(1, misfit.intervals);
  return misfit;
}

std::int64_t ClockOffset::BestNear(std::int64_t middle_ns, std::int64_t reach_ns, std::int64_t step_ns,
                                   const WheelHypotheses& wheels) const {
  std::int64_t best_ns = middle_ns;
  double least = std::numeric_limits<double>::infinity();
  const std::int64_t bound_ns = ToNanoseconds(options_.max_offset_s);
  for (std::int64_t offset_ns = middle_ns - reach_ns; offset_ns <= middle_ns + reach_ns; offset_ns += step_ns) {
    if (std::abs(offset_ns) > bound_ns) {
      continue;
    }
    const double total = MisfitAt(offset_ns, wheels).total;
    if (total < least) {
      least = total;
      best_ns = offset_ns;
    }
  }
  return best_ns;
}

bool ClockOffset::AddFix(const PoseFix& fix, const WheelHypotheses& wheels) {
  // Over longer intervals a shift makes more difference, and the fixes' own errors do not.
  if (!fixes_.empty() && fix.stamp_ns - fixes_.back().stamp_ns < ToNanoseconds(options_.clock_interval_s)) {
    return false;
  }
  fixes_.push_back(fix);
  if (fixes_.size() > kMaxFixes) {
    fixes_.pop_front();
  }
  if (fix.stamp_ns - last_search_ns_ < kSearchEveryNs) {
    return false;
  }
  last_search_ns_ = fix.stamp_ns;
  const Misfit now = MisfitAt(offset_ns_, wheels);
  const double gain_needed = offset_ns_ == 0 ? options_.clock_min_gain : kRefineShare * options_.clock_min_gain;
  if (now.intervals < options_.clock_min_intervals || now.total < gain_needed) {
    return false;
  }
  const std::int64_t coarse_ns = BestNear(0, ToNanoseconds(options_.max_offset_s), 50'000'000, wheels);
  const std::int64_t best_ns = BestNear(coarse_ns, 40'000'000, 10'000'000, wheels);
  const Misfit best = MisfitAt(best_ns, wheels);
  const bool refines = offset_ns_ != 0 && std::abs(best_ns - offset_ns_) <= kRefineNs;
  const bool better = best.intervals >= options_.clock_min_intervals &&
                      best.per_interval <= options_.clock_max_misfit &&
                      now.total - best.total >= (refines ? gain_needed : options_.clock_min_gain) &&
                      (refines || best.total <= options_.clock_max_left * now.total);
  const bool again = candidate_ns_ && std::abs(*candidate_ns_ - best_ns) <= kSameNs;
  candidate_ns_ = better ? std::optional(best_ns) : std::nullopt;
  if (!better || !again) {
    return false;
  }
  offset_ns_ = best_ns;
  return !refines;
}

}  // namespace floorloc
