// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "core/geometry/pose2.h"
#include "mapbuilder/fleet/drivable_area.h"

namespace floorloc {

/// What a vehicle with two driven wheels can do. Industrial trucks accelerate with 0.3 to 1 m/s^2.
struct DriveLimits {
  double speed_m_s = 0.4;
  double acceleration_m_s2 = 0.5;  ///< braking, too
  double lateral_m_s2 = 0.6;       ///< speed times yaw rate
  double yaw_rate_rad_s = 1.2;
  double yaw_acceleration_rad_s2 = 2.5;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// A vehicle with two driven wheels that drives from one random place to the next, without end. Its braking path is
/// always inside the area, so that it never leaves it.
class RoamingDrive {
 public:
  /// Starts standing at a random place. Throws std::invalid_argument when the limits do not pass Check().
  RoamingDrive(std::shared_ptr<const DrivableArea> area, const DriveLimits& limits, std::uint64_t seed);

  /// step_s: some hundredths of a second.
  void Advance(double step_s);
  /// Brakes and stands until Resume().
  void Halt() { halted_ = true; }
  void Resume() { halted_ = false; }
  bool stands() const { return speed_m_s_ == 0.0 && yaw_rate_rad_s_ == 0.0; }
  /// Puts the vehicle, which stands, at another place with another heading.
  void Carry();

  const Pose2& map_from_base() const { return map_from_base_; }
  /// Base frame: m/s, m/s, rad/s.
  Eigen::Vector3d twist() const { return {speed_m_s_, 0.0, yaw_rate_rad_s_}; }

 private:
  struct Command {
    double speed_m_s;
    double yaw_rate_rad_s;
  };

  Command Steer(double step_s) const;
  Command Brake(const Command& now, double step_s) const;
  bool StopsInside(Command command, double step_s) const;
  void ChooseGoal();

  std::shared_ptr<const DrivableArea> area_;
  DriveLimits limits_;
  cv::RNG rng_;
  Pose2 map_from_base_;
  Eigen::Vector2d goal_ = Eigen::Vector2d::Zero();
  double speed_m_s_ = 0.0;
  double yaw_rate_rad_s_ = 0.0;
  double stuck_s_ = 0.0;  // since it was last driven freely
  bool halted_ = false;
};

}  // namespace floorloc
