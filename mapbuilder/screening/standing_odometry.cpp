// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/standing_odometry.h"

#include <algorithm>

namespace floorloc {
namespace {

// Share of the floor that two images must have in common by odometry to contradict it by not matching.
constexpr double kMinOverlap = 0.5;

// Frames with fewer keypoints contradict nothing.
constexpr std::size_t kMinKeypoints = 50;

// How far a robot's motion may be from its last one: as SelectConsecutivePairs allows odometry.
constexpr double kMotionShare = 0.3;
constexpr double kMotionRadiusM = 0.03;
constexpr double kMotionYawRad = 0.1;

class SpanFinder {
 public:
  SpanFinder(const std::vector<OpenStep>& open, const StepRegistration& registration,
             const OdometryStepOptions& options)
      : open_(open), registration_(registration), options_(options) {}

  std::vector<FalseOdometryStep> Run() {
    for (std::size_t begin = 0; begin < open_.size();) {
      std::size_t end = begin + 1;
      while (end < open_.size() && Stands(begin) && Stands(end) && Follows(end)) {
        ++end;
      }
      if (Stands(begin) && IsContradicted(begin, end)) {
        // The wheels stopped and started again within the steps at the ends.
        const bool from_before = begin > 0 && Follows(begin) && !IsTaken(begin - 1);
        const bool to_after = end < open_.size() && Follows(end);
        end += to_after ? 1 : 0;
        Take(from_before ? begin - 1 : begin, end);
      }
      begin = end;
    }
    return std::move(steps_);
  }

 private:
  bool Stands(std::size_t i) const { return open_[i].times_usual <= options_.max_times_standing; }
  bool Follows(std::size_t i) const { return open_[i - 1].pair.second == open_[i].pair.first; }
  bool IsTaken(std::size_t i) const { return !steps_.empty() && steps_.back().first >= open_[i].pair.first; }
  const BuildFrame& Frame(int i) const { return registration_.frames[static_cast<std::size_t>(i)]; }
  double Seconds(int first, int second) const {
    return std::max(1e-3, ToSeconds(Frame(second).info.stamp_ns - Frame(first).info.stamp_ns));
  }
  bool ShouldMatch(const FramePair& pair) const;
  bool IsContradicted(std::size_t begin, std::size_t end) const;
  Pose2 TwistBefore(int frame) const;
  std::optional<Pose2> RegisterOnwards(const FramePair& pair, const Pose2& motion) const;
  void Take(std::size_t begin, std::size_t end);

  const std::vector<OpenStep>& open_;
  const StepRegistration& registration_;
  const OdometryStepOptions& options_;
  std::vector<FalseOdometryStep> steps_;
};

bool SpanFinder::ShouldMatch(const FramePair& pair) const {
  const auto first = static_cast<std::size_t>(pair.first);
  const auto second = static_cast<std::size_t>(pair.second);
  return Frame(pair.first).features.keypoints.size() >= kMinKeypoints &&
         Frame(pair.second).features.keypoints.size() >= kMinKeypoints &&
         OverlapShare(registration_.floors[first], registration_.floors[second], *pair.first_from_second) >=
             kMinOverlap;
}

bool SpanFinder::IsContradicted(std::size_t begin, std::size_t end) const {
  int contradicting = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (open_[i].by_images) {
      return true;
    }
    contradicting += ShouldMatch(open_[i].pair) ? 1 : 0;
  }
  return contradicting >= options_.min_standing_steps;
}

// Motion of the step that ends at a frame, per second.
Pose2 SpanFinder::TwistBefore(int frame) const {
  if (frame == 0 || Frame(frame - 1).survey != Frame(frame).survey || !Frame(frame - 1).odom_from_base) {
    return {};
  }
  const Eigen::Vector3d log = Frame(frame - 1).odom_from_base->Between(*Frame(frame).odom_from_base).Log();
  return Pose2::Exp(log / Seconds(frame - 1, frame));
}

std::optional<Pose2> SpanFinder::RegisterOnwards(const FramePair& pair, const Pose2& motion) const {
  const FramePair near{pair.first, pair.second, motion, kMotionRadiusM + kMotionShare * motion.translation().norm(),
                       kMotionYawRad + kMotionShare * std::abs(motion.yaw())};
  const std::vector<Link> links =
      RegisterPairs(registration_.frames, registration_.floors, {near}, registration_.options);
  return links.empty() ? std::nullopt : std::optional(links.front().first_from_second);
}

void SpanFinder::Take(std::size_t begin, std::size_t end) {
  Eigen::Vector3d twist = TwistBefore(open_[begin].pair.first).Log();
  for (std::size_t i = begin; i < end; ++i) {
    const FramePair& pair = open_[i].pair;
    const double seconds = Seconds(pair.first, pair.second);
    FalseOdometryStep step{pair.first,         pair.second,          *pair.first_from_second,
                           open_[i].by_images, open_[i].times_usual, true};
    if (!step.by_images) {
      step.by_images = RegisterOnwards(pair, Pose2::Exp(twist * seconds));
    }
    if (step.by_images) {
      twist = step.by_images->Log() / seconds;
    }
    steps_.push_back(step);
  }
}

}  // namespace

std::vector<FalseOdometryStep> FindStandingSteps(const std::vector<OpenStep>& open,
                                                 const StepRegistration& registration,
                                                 const OdometryStepOptions& options) {
  return SpanFinder(open, registration, options).Run();
}

}  // namespace floorloc
