// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/roaming_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr double kGoalReachedM = 0.15;
constexpr double kSteeringPerS = 1.5;     // yaw rate per heading error
constexpr double kFullSpeedCosine = 0.5;  // slower where the goal is more than 60 degrees to the side
constexpr double kPatienceS = 1.5;        // blocked for so long, another goal is chosen
constexpr double kLateralReserve = 0.8;   // for the time that the speed needs to follow the yaw rate
constexpr int kGoalAttempts = 50;

double Towards(double now, double wanted, double step) { return now + std::clamp(wanted - now, -step, step); }

}  // namespace

void DriveLimits::Check() const {
  RequireOption(speed_m_s > 0.0 && speed_m_s <= 3.0, "the speed must be more than 0 and at most 3 m/s");
  RequireOption(acceleration_m_s2 > 0.0, "acceleration_m_s2 must be positive");
  RequireOption(lateral_m_s2 > 0.0, "lateral_m_s2 must be positive");
  RequireOption(yaw_rate_rad_s > 0.0, "yaw_rate_rad_s must be positive");
  RequireOption(yaw_acceleration_rad_s2 > 0.0, "yaw_acceleration_rad_s2 must be positive");
}

RoamingDrive::RoamingDrive(std::shared_ptr<const DrivableArea> area, const DriveLimits& limits, std::uint64_t seed)
    : area_(std::move(area)), limits_(limits), rng_(seed) {
  limits_.Check();
  Carry();
}

void RoamingDrive::Carry() {
  const Eigen::Vector2d place = area_->RandomPoint(rng_);
  map_from_base_ = Pose2(place.x(), place.y(), rng_.uniform(-std::numbers::pi, std::numbers::pi));
  ChooseGoal();
}

// A place that can be driven to straight on, rather a far one.
void RoamingDrive::ChooseGoal() {
  const Eigen::Vector2d here = map_from_base_.translation();
  double best_m = -1.0;
  for (int i = 0, found = 0; i < kGoalAttempts && found < 4; ++i) {
    const Eigen::Vector2d goal = area_->RandomPoint(rng_);
    const double distance_m = (goal - here).norm();
    const bool reachable = area_->ContainsLine(here, goal);
    found += reachable ? 1 : 0;
    if (best_m < 0.0 || (reachable && distance_m > best_m)) {
      goal_ = goal;
      best_m = reachable ? distance_m : 0.0;
    }
  }
  stuck_s_ = 0.0;
}

RoamingDrive::Command RoamingDrive::Steer(double step_s) const {
  const Eigen::Vector2d to_goal = map_from_base_.Inverse() * goal_;
  const double error_rad = std::atan2(to_goal.y(), to_goal.x());
  const double yaw_acceleration = limits_.yaw_acceleration_rad_s2;
  // Turns no faster than it can stop turning when it faces the goal.
  const double limit_rad_s = std::min({limits_.yaw_rate_rad_s, std::sqrt(yaw_acceleration * std::abs(error_rad)),
                                       kLateralReserve * limits_.lateral_m_s2 / std::max(speed_m_s_, 1e-6)});
  const double yaw_rate = Towards(yaw_rate_rad_s_, std::clamp(kSteeringPerS * error_rad, -limit_rad_s, limit_rad_s),
                                  yaw_acceleration * step_s);
  const double ahead = std::clamp(std::cos(error_rad) / kFullSpeedCosine, 0.0, 1.0);
  const double wanted =
      std::min(limits_.speed_m_s * ahead, kLateralReserve * limits_.lateral_m_s2 / std::max(std::abs(yaw_rate), 1e-6));
  return {Towards(speed_m_s_, wanted, limits_.acceleration_m_s2 * step_s), yaw_rate};
}

RoamingDrive::Command RoamingDrive::Brake(const Command& now, double step_s) const {
  return {Towards(now.speed_m_s, 0.0, limits_.acceleration_m_s2 * step_s),
          Towards(now.yaw_rate_rad_s, 0.0, limits_.yaw_acceleration_rad_s2 * step_s)};
}

// Whether the vehicle stays inside when it does this for a step and then brakes.
bool RoamingDrive::StopsInside(Command command, double step_s) const {
  Pose2 pose = map_from_base_;
  while (command.speed_m_s > 0.0) {
    pose = pose * Pose2::Exp(Eigen::Vector3d(command.speed_m_s, 0.0, command.yaw_rate_rad_s) * step_s);
    if (!area_->Contains(pose.translation())) {
      return false;
    }
    command = Brake(command, step_s);
  }
  return true;
}

void RoamingDrive::Advance(double step_s) {
  const Command now = {speed_m_s_, yaw_rate_rad_s_};
  Command next = halted_ ? Brake(now, step_s) : Steer(step_s);
  if (!halted_ && !StopsInside(next, step_s)) {
    next = Brake(now, step_s);
    if (speed_m_s_ == 0.0) {  // turns on the spot
      next.yaw_rate_rad_s = Steer(step_s).yaw_rate_rad_s;
    }
  }
  speed_m_s_ = next.speed_m_s;
  yaw_rate_rad_s_ = next.yaw_rate_rad_s;
  map_from_base_ = map_from_base_ * Pose2::Exp(twist() * step_s);
  const bool turns = std::abs(yaw_rate_rad_s_) > 0.2;
  stuck_s_ = speed_m_s_ > 0.05 || turns || halted_ ? 0.0 : stuck_s_ + step_s;
  if ((goal_ - map_from_base_.translation()).norm() < kGoalReachedM || stuck_s_ > kPatienceS) {
    ChooseGoal();
  }
}

}  // namespace floorloc
