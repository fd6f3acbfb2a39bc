// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/motion_pairs.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace floorloc {
namespace {

std::vector<Motion> MotionsByFrameCount(std::size_t poses, const MotionOptions& options) {
  const auto delta = static_cast<std::size_t>(options.delta);
  std::vector<Motion> motions;
  for (std::size_t i = 0; i + delta < poses; i += options.all_pairs ? 1 : delta) {
    motions.push_back({i, i + delta});
  }
  return motions;
}

double DistanceBetween(const StampedPose3& a, const StampedPose3& b) {
  return (b.translation_m - a.translation_m).norm();
}

double AngleBetween(const StampedPose3& a, const StampedPose3& b) { return a.rotation.angularDistance(b.rotation); }

std::vector<double> PathLengths(const Trajectory& trajectory) {
  std::vector<double> lengths = {0.0};
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    lengths.push_back(lengths.back() + DistanceBetween(trajectory[i - 1], trajectory[i]));
  }
  return lengths;
}

std::vector<double> TimesSinceStart(const Trajectory& trajectory) {
  std::vector<double> times;
  for (const StampedPose3& pose : trajectory) {
    times.push_back(ToSeconds(pose.stamp_ns - trajectory.front().stamp_ns));
  }
  return times;
}

// The pose after `from` whose progress since it is nearest to delta, the earliest of several. Progress does not
// decrease.
std::optional<std::size_t> NearestAhead(const std::vector<double>& progress, std::size_t from,
                                        const MotionOptions& options) {
  const auto first = progress.begin() + static_cast<std::ptrdiff_t>(from) + 1;
  if (first == progress.end()) {
    return std::nullopt;
  }
  const auto miss = [&](auto place) { return std::abs(*place - progress[from] - options.delta); };
  auto nearest = std::lower_bound(first, progress.end(), progress[from] + options.delta);
  if (nearest == progress.end() || (nearest != first && miss(nearest - 1) <= miss(nearest))) {
    nearest = std::lower_bound(first, progress.end(), *(nearest - 1));
  }
  if (miss(nearest) > options.relative_tolerance * options.delta) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(nearest - progress.begin());
}

std::vector<Motion> MotionsByProgress(const std::vector<double>& progress, const MotionOptions& options) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < progress.size();) {
    const std::optional<std::size_t> end = NearestAhead(progress, i, options);
    if (end) {
      motions.push_back({i, *end});
    }
    i = end && !options.all_pairs ? *end : i + 1;
  }
  return motions;
}

// Poses where the steps summed up since the last such pose reach delta.
template <typename Step>
std::vector<std::size_t> Milestones(const Trajectory& trajectory, double delta, Step step) {
  std::vector<std::size_t> milestones;
  double sum = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    sum += step(trajectory[i - 1], trajectory[i]);
    if (sum >= delta) {
      milestones.push_back(i);
      sum = 0.0;
    }
  }
  return milestones;
}

std::vector<Motion> Consecutive(const std::vector<std::size_t>& milestones) {
  std::vector<Motion> motions;
  for (std::size_t i = 1; i < milestones.size(); ++i) {
    motions.push_back({milestones[i - 1], milestones[i]});
  }
  return motions;
}

std::vector<Motion> RotationPairs(const Trajectory& trajectory, const MotionOptions& options) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    for (std::size_t j = i + 1; j < trajectory.size(); ++j) {
      const double miss = std::abs(AngleBetween(trajectory[i], trajectory[j]) - options.delta);
      if (miss <= options.relative_tolerance * options.delta) {
        motions.push_back({i, j});
      }
    }
  }
  return motions;
}

std::vector<Motion> ConsecutiveRotations(const Trajectory& trajectory, double delta_rad) {
  std::vector<std::size_t> milestones = Milestones(trajectory, delta_rad, AngleBetween);
  milestones.insert(milestones.begin(), 0);
  return Consecutive(milestones);
}

}  // namespace

void MotionOptions::Check() const {
  if (!(delta > 0.0)) {
    throw std::invalid_argument("delta must be greater than 0");
  }
  if (unit == DeltaUnit::kFrames && (delta != std::floor(delta) || delta > 1e9)) {
    throw std::invalid_argument("a delta in frames must be a whole number");
  }
  if (unit == DeltaUnit::kRadians && delta > std::numbers::pi) {
    throw std::invalid_argument("a delta of turning must be at most half a turn (180 deg)");
  }
  if (!(relative_tolerance >= 0.0)) {
    throw std::invalid_argument("the tolerance of delta must not be negative");
  }
}

std::vector<Motion> SelectMotions(const Trajectory& trajectory, const MotionOptions& options) {
  options.Check();
  if (trajectory.empty()) {
    return {};
  }
  switch (options.unit) {
    case DeltaUnit::kFrames:
      return MotionsByFrameCount(trajectory.size(), options);
    case DeltaUnit::kSeconds:
      return MotionsByProgress(TimesSinceStart(trajectory), options);
    case DeltaUnit::kMetres:
      return options.all_pairs ? MotionsByProgress(PathLengths(trajectory), options)
                               : Consecutive(Milestones(trajectory, options.delta, DistanceBetween));
    case DeltaUnit::kRadians:
      return options.all_pairs ? RotationPairs(trajectory, options) : ConsecutiveRotations(trajectory, options.delta);
  }
  assert(false);
  return {};
}

}  // namespace floorloc
