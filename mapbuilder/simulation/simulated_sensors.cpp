// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_sensors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kStartNs = 1'700'000'000'000'000'000;

Eigen::Vector3d SlippedMotion(const std::vector<WheelSlip>& slips, double from_s, double to_s) {
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  for (const WheelSlip& slip : slips) {
    const double overlap_s = std::min(to_s, slip.from_s + slip.duration_s) - std::max(from_s, slip.from_s);
    motion += std::max(0.0, overlap_s) * slip.twist;
  }
  return motion;
}

Eigen::Vector3d Gaussian3(cv::RNG& rng, double sigma) {
  const double x = rng.gaussian(sigma);
  const double y = rng.gaussian(sigma);
  const double z = rng.gaussian(sigma);
  return {x, y, z};
}

// A bias with a random initial value and a random walk.
struct WanderingBias {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  double walk = 0.0;

  void Advance(double step_s, cv::RNG& rng) { value += Gaussian3(rng, walk * std::sqrt(step_s)); }
};

// Resonances of chassis and motor mounts.
struct Vibration {
  std::array<double, 3> frequency_hz{};
  std::array<double, 3> phase{};

  Eigen::Vector3d At(double time_s) const {
    Eigen::Vector3d shake;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      shake[axis] = std::numbers::sqrt2 * std::sin(2.0 * kPi * frequency_hz[i] * time_s + phase[i]);
    }
    return shake;
  }
};

Vibration DrawVibration(cv::RNG& rng) {
  Vibration vibration;
  for (std::size_t i = 0; i < 3; ++i) {
    vibration.frequency_hz[i] = rng.uniform(17.0, 43.0);
    vibration.phase[i] = rng.uniform(0.0, 2.0 * kPi);
  }
  return vibration;
}

// Integral up to `time_s` of a smooth pulse of unit area and one second's length, centred at 0.
double PulseBefore(double time_s) {
  const double t = std::clamp(time_s + 0.5, 0.0, 1.0);
  return t - std::sin(2.0 * kPi * t) / (2.0 * kPi);
}

// Adds the effect of a lift: rotation about z, rise and fall, and tremor.
void AddJolt(const ImuJolt& jolt, double from_s, double to_s, ImuSample& sample) {
  const double share = PulseBefore(to_s - jolt.time_s) - PulseBefore(from_s - jolt.time_s);
  const double strength = share / (to_s - from_s);  // 0 outside, 2 at the centre
  const double t = 0.5 * (from_s + to_s) - jolt.time_s;
  sample.angular_velocity += strength * Eigen::Vector3d(0.3 * std::sin(9.0 * t), 0.2 * std::sin(13.0 * t), 0.0);
  sample.angular_velocity.z() += jolt.turn_rad * strength;
  sample.acceleration += strength * Eigen::Vector3d(0.8 * std::sin(11.0 * t), 0.6 * std::sin(8.0 * t), 0.0);
  sample.acceleration.z() += 1.5 * strength * std::cos(2.0 * kPi * 1.5 * t);
}

Eigen::Vector2d VelocityInMap(const PoseAtTime& motion, double time_s) {
  constexpr double kHalfStepS = 0.005;
  const double before_s = std::max(0.0, time_s - kHalfStepS);
  const double after_s = time_s + kHalfStepS;
  return (motion(after_s).translation() - motion(before_s).translation()) / (after_s - before_s);
}

// True mean rates and accelerations between two times.
ImuSample PerfectSample(const PoseAtTime& motion, double from_s, double to_s) {
  const double step_s = to_s - from_s;
  const Pose2 before = motion(from_s);
  const double turn = WrapAngle(motion(to_s).yaw() - before.yaw());
  const Pose2 map_from_middle(0.0, 0.0, before.yaw() + 0.5 * turn);
  const Eigen::Vector2d change = VelocityInMap(motion, to_s) - VelocityInMap(motion, from_s);
  ImuSample sample;
  sample.stamp_ns = SimulatedStamp(to_s);
  sample.angular_velocity.z() = turn / step_s;
  sample.acceleration.head<2>() = map_from_middle.Inverse() * Eigen::Vector2d(change / step_s);
  sample.acceleration.z() = kGravity;
  return sample;
}

}  // namespace

std::int64_t SimulatedStamp(double time_s) { return kStartNs + std::llround(time_s * 1e9); }

double SimulatedSeconds(std::int64_t stamp_ns) { return 1e-9 * static_cast<double>(stamp_ns - kStartNs); }

OdometryErrors OdometryErrors::Scaled(double factor) const {
  return {scale * factor, yaw_scale * factor, drift_rad_per_m * factor, noise_m * factor, noise_rad * factor};
}

ImuErrors ImuErrors::Scaled(double factor) const {
  return {gyro_noise * factor, gyro_bias * factor,  gyro_walk * factor, accel_noise * factor,
          accel_bias * factor, accel_walk * factor, vibration * factor};
}

void WheelOptions::Check() const {
  RequireOption(errors.scale >= 0.0, "errors.scale must not be negative");
  RequireOption(errors.yaw_scale >= 0.0, "errors.yaw_scale must not be negative");
  RequireOption(errors.drift_rad_per_m >= 0.0, "errors.drift_rad_per_m must not be negative");
  RequireOption(errors.noise_m >= 0.0, "errors.noise_m must not be negative");
  RequireOption(errors.noise_rad >= 0.0, "errors.noise_rad must not be negative");
}

void ImuOptions::Check() const {
  RequireOption(rate_hz > 0.0, "rate_hz must be positive");
  RequireOption(duration_s >= 0.0, "duration_s must not be negative");
  RequireOption(errors.gyro_noise >= 0.0, "errors.gyro_noise must not be negative");
  RequireOption(errors.gyro_bias >= 0.0, "errors.gyro_bias must not be negative");
  RequireOption(errors.gyro_walk >= 0.0, "errors.gyro_walk must not be negative");
  RequireOption(errors.accel_noise >= 0.0, "errors.accel_noise must not be negative");
  RequireOption(errors.accel_bias >= 0.0, "errors.accel_bias must not be negative");
  RequireOption(errors.accel_walk >= 0.0, "errors.accel_walk must not be negative");
  RequireOption(errors.vibration >= 0.0, "errors.vibration must not be negative");
}

SimulatedWheels::SimulatedWheels(const OdometryErrors& errors, std::uint64_t seed) : errors_(errors), rng_(seed) {
  scale_ += rng_.gaussian(errors.scale);
  yaw_scale_ += rng_.gaussian(errors.yaw_scale);
  drift_rad_per_m_ = rng_.gaussian(errors.drift_rad_per_m);
}

Eigen::Vector3d SimulatedWheels::Measure(Eigen::Vector3d motion) {
  const double distance_m = motion.head<2>().norm();
  const double spread = std::sqrt(distance_m);
  motion.x() = scale_ * motion.x() + rng_.gaussian(errors_.noise_m) * spread;
  motion.y() = scale_ * motion.y() + rng_.gaussian(errors_.noise_m) * spread;
  motion.z() = yaw_scale_ * motion.z() + drift_rad_per_m_ * distance_m + rng_.gaussian(errors_.noise_rad) * spread;
  return motion;
}

Trajectory SimulateOdometry(const PoseAtTime& motion, const std::vector<std::int64_t>& stamps_ns,
                            const WheelOptions& options) {
  options.Check();
  constexpr double kStepS = 0.02;
  SimulatedWheels wheels(options.errors, options.seed);
  Trajectory odometry;
  Pose2 odom_from_base;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    if (i > 0) {
      const double from_s = SimulatedSeconds(stamps_ns[i - 1]);
      const double to_s = SimulatedSeconds(stamps_ns[i]);
      const int steps = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kStepS)));
      const double step_s = (to_s - from_s) / steps;
      for (int k = 0; k < steps; ++k) {
        const double start_s = from_s + k * step_s;
        const double end_s = from_s + (k + 1) * step_s;
        const Eigen::Vector3d rolled = motion(start_s).Between(motion(end_s)).Log();
        const Eigen::Vector3d measured = wheels.Measure(rolled);
        odom_from_base = odom_from_base * Pose2::Exp(measured + SlippedMotion(options.slips, start_s, end_s));
      }
    }
    odometry.push_back(StampedPose3::FromPose2(stamps_ns[i], odom_from_base));
  }
  return odometry;
}

std::vector<ImuSample> SimulateImu(const PoseAtTime& motion, const ImuOptions& options) {
  options.Check();
  constexpr double kVibrationSpeed = 0.3;  // m/s at which the vibration has its nominal strength
  const ImuErrors& errors = options.errors;
  cv::RNG rng(options.seed);
  WanderingBias gyro_bias{Gaussian3(rng, errors.gyro_bias), errors.gyro_walk};
  WanderingBias accel_bias{Gaussian3(rng, errors.accel_bias), errors.accel_walk};
  const Vibration vibration = DrawVibration(rng);
  const int count = static_cast<int>(std::floor(options.duration_s * options.rate_hz + 1e-6));
  std::vector<ImuSample> samples;
  for (int i = 1; i <= count; ++i) {
    const double from_s = (i - 1) / options.rate_hz;
    const double to_s = i / options.rate_hz;
    ImuSample sample = PerfectSample(motion, from_s, to_s);
    for (const ImuJolt& jolt : options.jolts) {
      AddJolt(jolt, from_s, to_s, sample);
    }
    const double speed = VelocityInMap(motion, to_s).norm();
    gyro_bias.Advance(to_s - from_s, rng);
    accel_bias.Advance(to_s - from_s, rng);
    sample.angular_velocity += gyro_bias.value + Gaussian3(rng, errors.gyro_noise);
    sample.acceleration += accel_bias.value + Gaussian3(rng, errors.accel_noise) +
                           errors.vibration * speed / kVibrationSpeed * vibration.At(to_s);
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace floorloc
