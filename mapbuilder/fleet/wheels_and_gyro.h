// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>

#include "mapbuilder/simulation/simulated_sensors.h"

namespace floorloc {

/// Odometry as a robot with wheels and an IMU makes it: distances of the wheels, turns of the gyro, whose bias was
/// averaged while the robot stood.
class WheelsAndGyro {
 public:
  static constexpr double kGyroRateHz = 100.0;
  static constexpr double kStandingS = 1.0;  ///< over which the bias was averaged

  WheelsAndGyro(const OdometryErrors& wheels, const ImuErrors& imu, std::uint64_t seed);

  /// motion: true, within step_s, base frame, Pose2::Log(): m, m, rad. What the odometry says instead.
  Eigen::Vector3d Measure(const Eigen::Vector3d& motion, double step_s);

 private:
  SimulatedWheels wheels_;
  ImuErrors imu_;
  cv::RNG rng_;
  double bias_rad_s_ = 0.0;  // what the average left of it, and its walk since
};

}  // namespace floorloc
