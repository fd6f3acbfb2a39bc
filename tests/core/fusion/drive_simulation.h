// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/fusion/filter_options.h"
#include "core/fusion/filter_state.h"
#include "core/fusion/measurements.h"

namespace floorloc::fusion_test {

constexpr std::int64_t kStartNs = 1'000'000'000'000;
constexpr std::int64_t kWheelNs = 20'000'000;
constexpr std::int64_t kImuNs = 10'000'000;
constexpr std::int64_t kFixNs = 250'000'000;

inline std::int64_t ToNs(double seconds) { return static_cast<std::int64_t>(std::llround(1e9 * seconds)); }

/// Errors of the sensors of a simulated drive.
struct SensorErrors {
  OdometryBias wheels;
  ImuBias imu;
  double wheel_noise_m = 0.003;  ///< after one metre
  double wheel_noise_rad = 0.005;
  double gyro_noise = 0.01;  ///< per reading
  double accelerometer_noise = 0.3;
  double fix_sigma_m = 4e-4;
  double fix_sigma_rad = 6e-4;
};

/// A drive with curves and changes of speed: exact motion and simulated measurements.
class DriveSimulation {
 public:
  explicit DriveSimulation(std::uint32_t seed, const SensorErrors& errors = {}) : random_(seed), errors_(errors) {
    std::uniform_real_distribution<double> phase(0.0, 6.28);
    phase_a_ = phase(random_);
    phase_b_ = phase(random_);
  }

  double Speed(double t) const { return 0.4 + 0.2 * std::sin(0.5 * t + phase_a_); }
  double YawRate(double t) const { return 0.4 * std::sin(0.3 * t + phase_b_); }
  double Acceleration(double t) const { return 0.1 * std::cos(0.5 * t + phase_a_); }

  /// The true motion between two times.
  Pose2 Motion(double from_s, double to_s) const {
    constexpr int kPieces = 20;
    const double dt = (to_s - from_s) / kPieces;
    Pose2 motion;
    for (int i = 0; i < kPieces; ++i) {
      const double t = from_s + (i + 0.5) * dt;
      motion = motion * Pose2::Exp({Speed(t) * dt, 0.0, YawRate(t) * dt});
    }
    return motion;
  }

  MotionIncrement Wheels(std::int64_t from_ns, std::int64_t to_ns) {
    const Pose2 motion = Motion(Seconds(from_ns), Seconds(to_ns));
    const double path = motion.translation().norm();
    const double yaw = (motion.yaw() - errors_.wheels.drift_rad_per_m * path) / (1.0 + errors_.wheels.yaw_scale) +
                       Normal(errors_.wheel_noise_rad * std::sqrt(path));
    const double shrink = 1.0 / (1.0 + errors_.wheels.scale);
    const double noise = errors_.wheel_noise_m * std::sqrt(path);
    return {from_ns, to_ns, Pose2(shrink * motion.x() + Normal(noise), shrink * motion.y() + Normal(noise), yaw), {}};
  }

  // The mean since the reading before.
  ImuReading Imu(std::int64_t stamp_ns) {
    const double t = Seconds(stamp_ns - kImuNs / 2);
    return {stamp_ns, YawRate(t) + errors_.imu.yaw_rate_rad_s + Normal(errors_.gyro_noise),
            Eigen::Vector2d(Acceleration(t) + Normal(errors_.accelerometer_noise),
                            Speed(t) * YawRate(t) + Normal(errors_.accelerometer_noise)) +
                errors_.imu.acceleration_m_s2};
  }

  /// A motion measured by visual odometry, with its covariance.
  MotionIncrement Vision(std::int64_t from_ns, std::int64_t to_ns) {
    const Pose2 motion = Motion(Seconds(from_ns), Seconds(to_ns));
    return {from_ns, to_ns,
            Pose2(motion.x() + Normal(errors_.fix_sigma_m), motion.y() + Normal(errors_.fix_sigma_m),
                  motion.yaw() + Normal(errors_.fix_sigma_rad)),
            FixCovariance()};
  }

  PoseFix Fix(std::int64_t stamp_ns, const Pose2& truth) {
    return {stamp_ns,
            Pose2(truth.x() + Normal(errors_.fix_sigma_m), truth.y() + Normal(errors_.fix_sigma_m),
                  truth.yaw() + Normal(errors_.fix_sigma_rad)),
            FixCovariance(), 1e-9};
  }

  Eigen::Matrix3d FixCovariance() const {
    const double m = errors_.fix_sigma_m;
    const double rad = errors_.fix_sigma_rad;
    return Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal();
  }

  double Normal(double sigma) { return std::normal_distribution<double>(0.0, 1.0)(random_) * sigma; }

  static double Seconds(std::int64_t stamp_ns) { return 1e-9 * static_cast<double>(stamp_ns - kStartNs); }

 private:
  std::mt19937 random_;
  SensorErrors errors_;
  double phase_a_ = 0.0;
  double phase_b_ = 0.0;
};

}  // namespace floorloc::fusion_test
