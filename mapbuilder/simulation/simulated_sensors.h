// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/io/survey.h"
#include "core/io/trajectory.h"

namespace floorloc {

/// Pose as a function of the time in seconds since the recording's start.
using PoseAtTime = std::function<Pose2(double time_s)>;

/// Conversion between seconds since the recording's start and stamps.
std::int64_t SimulatedStamp(double time_s);
double SimulatedSeconds(std::int64_t stamp_ns);

/// Errors of wheel odometry. Scales and drift are constant per recording, drawn with the given standard deviations.
struct OdometryErrors {
  double scale = 0.005;      ///< of distances
  double yaw_scale = 0.005;  ///< of turns
  double drift_rad_per_m = 0.0025;
  double noise_m = 0.003;    ///< after one metre; grows with the square root of the distance
  double noise_rad = 0.005;  ///< after one metre

  /// All errors multiplied by a factor.
  OdometryErrors Scaled(double factor) const;
};

/// A period of wheel slip, in which odometry reports this motion in addition to the true one.
struct WheelSlip {
  double from_s = 0.0;
  double duration_s = 0.0;
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< base frame: m/s, m/s, rad/s
};

struct WheelOptions {
  OdometryErrors errors;
  std::vector<WheelSlip> slips;
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Wheels that measure increments of motion one after the other.
class SimulatedWheels {
 public:
  SimulatedWheels(const OdometryErrors& errors, std::uint64_t seed);

  /// motion: true, in the base frame: Pose2::Log(), m, m, rad. What the wheels say instead.
  Eigen::Vector3d Measure(Eigen::Vector3d motion);

 private:
  OdometryErrors errors_;
  cv::RNG rng_;
  double scale_ = 1.0;
  double yaw_scale_ = 1.0;
  double drift_rad_per_m_ = 0.0;
};

/// Simulates wheel odometry of a true motion without jumps at the given stamps: odom_from_base, starting at the
/// identity.
Trajectory SimulateOdometry(const PoseAtTime& motion, const std::vector<std::int64_t>& stamps_ns,
                            const WheelOptions& options);

/// Errors of an inexpensive IMU on a driving robot. Biases are drawn per recording and axis.
struct ImuErrors {
  double gyro_noise = 0.0012;  ///< rad/s, per sample
  double gyro_bias = 0.006;    ///< rad/s
  double gyro_walk = 0.0001;   ///< rad/s after one second; grows with the square root of time
  double accel_noise = 0.02;   ///< m/s^2, per sample
  double accel_bias = 0.06;    ///< m/s^2
  double accel_walk = 0.0008;  ///< m/s^2 after one second
  double vibration = 0.15;     ///< m/s^2 at 0.3 m/s; grows with the speed

  /// All errors multiplied by a factor.
  ImuErrors Scaled(double factor) const;
};

/// IMU signal of lifting, turning and putting down the robot, within half a second before and after.
struct ImuJolt {
  double time_s = 0.0;
  double turn_rad = 0.0;
};

struct ImuOptions {
  double rate_hz = 100.0;
  double duration_s = 0.0;
  ImuErrors errors;
  std::vector<ImuJolt> jolts;
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

inline constexpr double kGravity = 9.80665;  ///< m/s^2

/// Simulates an IMU at the base origin, its axes parallel to the base's, of a true motion without jumps: each sample is
/// the mean since the previous one. Gravity is measured on +z.
std::vector<ImuSample> SimulateImu(const PoseAtTime& motion, const ImuOptions& options);

}  // namespace floorloc
