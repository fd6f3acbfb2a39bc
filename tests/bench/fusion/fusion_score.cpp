// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fusion_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/evaluation/consistency.h"

namespace floorloc {
namespace {

bool IsRight(const FusionSample& sample) {
  if (!sample.estimate) {
    return false;
  }
  const Pose2 error = sample.truth.Between(sample.estimate->map_from_base);
  return error.translation().norm() <= kWrongM && std::abs(error.yaw()) <= kWrongRad;
}

// A time interval after a kidnap.
struct Interval {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;  // exclusive

  bool Contains(std::int64_t stamp_ns) const { return stamp_ns >= from_ns && stamp_ns < to_ns; }
};

bool AnyContains(const std::vector<Interval>& intervals, std::int64_t stamp_ns) {
  return std::any_of(intervals.begin(), intervals.end(),
                     [stamp_ns](const Interval& interval) { return interval.Contains(stamp_ns); });
}

// The first time in the interval from which the pose stays right for one second.
std::optional<std::int64_t> RecoveryTime(const std::vector<FusionSample>& samples, const Interval& interval) {
  constexpr std::int64_t kSteadyNs = 1'000'000'000;
  std::optional<std::int64_t> right_since;
  for (const FusionSample& sample : samples) {
    if (!interval.Contains(sample.stamp_ns)) {
      continue;
    }
    if (!IsRight(sample)) {
      right_since.reset();
    } else if (!right_since) {
      right_since = sample.stamp_ns;
    }
    if (right_since && sample.stamp_ns - *right_since >= kSteadyNs) {
      return right_since;
    }
  }
  return std::nullopt;
}

// Scores the recoveries. Returns the intervals from each kidnap to its recovery, or to the next kidnap or the end.
std::vector<Interval> ScoreRecoveries(const std::vector<FusionSample>& samples,
                                      const std::vector<std::int64_t>& kidnaps_ns, FusionScore& score) {
  std::vector<Interval> lost;
  for (std::size_t i = 0; i < kidnaps_ns.size(); ++i) {
    const bool last = i + 1 == kidnaps_ns.size();
    Interval interval{kidnaps_ns[i], last ? std::numeric_limits<std::int64_t>::max() : kidnaps_ns[i + 1]};
    if (const auto recovered_ns = RecoveryTime(samples, interval)) {
      score.recovery_s.push_back(1e-9 * static_cast<double>(*recovered_ns - kidnaps_ns[i]));
      interval.to_ns = *recovered_ns + 1;
    } else {
      ++score.never_recovered;
    }
    lost.push_back(interval);
  }
  return lost;
}

double JumpM(const FusionSample& before, const FusionSample& after) {
  const Pose2 estimated = before.estimate->map_from_base.Between(after.estimate->map_from_base);
  const Pose2 real = before.truth.Between(after.truth);
  return (estimated.translation() - real.translation()).norm();
}

}  // namespace

double FusionScore::RmseM() const {
  return judged == 0 ? 0.0 : std::sqrt(squared_error_m2 / static_cast<double>(judged));
}

double FusionScore::MeanNees() const { return judged == 0 ? 0.0 : nees / static_cast<double>(judged); }

void FusionScore::Add(const FusionScore& other) {
  samples += other.samples;
  called_good += other.called_good;
  wrong_called_good += other.wrong_called_good;
  judged += other.judged;
  squared_error_m2 += other.squared_error_m2;
  nees += other.nees;
  worst_jump_m = std::max(worst_jump_m, other.worst_jump_m);
  recovery_s.insert(recovery_s.end(), other.recovery_s.begin(), other.recovery_s.end());
  never_recovered += other.never_recovered;
}

FusionScore ScoreFusion(const std::vector<FusionSample>& samples, const std::vector<std::int64_t>& kidnaps_ns) {
  FusionScore score;
  const std::vector<Interval> lost = ScoreRecoveries(samples, kidnaps_ns, score);
  std::vector<Interval> settling;
  for (const std::int64_t kidnap_ns : kidnaps_ns) {
    settling.push_back({kidnap_ns, kidnap_ns + std::llround(1e9 * kSettleS)});
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const FusionSample& sample = samples[i];
    if (!sample.estimate) {
      continue;
    }
    const FusedPose& estimate = *sample.estimate;
    const bool good = estimate.state == TrackingState::kLocalized;
    score.samples += 1;
    score.called_good += good ? 1 : 0;
    score.wrong_called_good += good && !IsRight(sample) ? 1 : 0;
    if (!AnyContains(settling, sample.stamp_ns)) {
      score.judged += 1;
      score.squared_error_m2 += (estimate.map_from_base.translation() - sample.truth.translation()).squaredNorm();
      score.nees += Nees(sample.truth, estimate.map_from_base, estimate.covariance);
    }
    if (i > 0 && samples[i - 1].estimate && !AnyContains(lost, sample.stamp_ns)) {
      score.worst_jump_m = std::max(score.worst_jump_m, JumpM(samples[i - 1], sample));
    }
  }
  return score;
}

}  // namespace floorloc
