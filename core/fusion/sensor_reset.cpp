// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/sensor_reset.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

double Square(double x) { return x * x; }

// What was learnt of a group of errors, as it was in another state, and independent of the pose.
void TakeErrors(int first, int rows, const FilterState& from, FilterState* state) {
  state->covariance.middleRows(first, rows).setZero();
  state->covariance.middleCols(first, rows).setZero();
  state->covariance.block(first, first, rows, rows) = from.covariance.block(first, first, rows, rows);
}

}  // namespace

FilterState InitialState(std::int64_t stamp_ns, const PoseFilterOptions& options) {
  using namespace error_row;  // NOLINT: rows are named all over this function
  FilterState state;
  state.stamp_ns = stamp_ns;
  auto variance = state.covariance.diagonal();
  variance.segment<2>(kVelocity).setConstant(Square(options.motion_prior.speed_m_s));
  variance(kGyroBias) = Square(options.imu.gyro_bias);
  variance.segment<2>(kAccelerationBias).setConstant(Square(options.imu.accelerometer_bias));
  variance(kOdometryScale) = Square(options.odometry.scale);
  variance(kOdometryYawScale) = Square(options.odometry.yaw_scale);
  variance(kOdometryDrift) = Square(options.odometry.drift_rad_per_m);
  variance(kVisionScale) = Square(options.vision.scale);
  variance.segment<3>(kFixBias) = FixBiasVariance(options.shared_fix);
  return state;
}

void ForgetSensors(const FilterState& initial, const FilterState& imu, const FilterState& wheels, FilterState* state) {
  TakeErrors(error_row::kVelocity, 2, initial, state);
  TakeErrors(error_row::kGyroBias, 3, imu, state);
  TakeErrors(error_row::kOdometryScale, 3, wheels, state);
  state->velocity_m_s.setZero();
  state->imu_bias = imu.imu_bias;
  state->odometry_bias = wheels.odometry_bias;
}

void SetVelocity(const PoseFix& from, const PoseFix& to, const MotionPrior& prior, FilterState* state) {
  const double seconds = 1e-9 * static_cast<double>(to.stamp_ns - from.stamp_ns);
  const Pose2 motion = from.map_from_base.Between(to.map_from_base);
  const double measured = Square(0.5 * prior.acceleration_m_s2 * seconds);
  const double known = Square(prior.speed_m_s) / (Square(prior.speed_m_s) + measured);
  state->velocity_m_s = known / seconds * (motion.rotation().transpose() * motion.translation());
  state->covariance.block<2, 2>(error_row::kVelocity, error_row::kVelocity) =
      known * measured * Eigen::Matrix2d::Identity();
}

double RaisedNoiseFactor(const FilterState& state, double off_m, double path_m, const PoseFilterOptions& options) {
  constexpr double kSigmas = 4.0;  // the next one like it passes the gate of five
  constexpr double kMinPathM = 0.05;
  const double variance = Square(options.odometry.noise_m) * std::max(path_m, kMinPathM);
  return std::clamp(Square(off_m / kSigmas) / variance, state.wheel_noise_factor, options.adaptation.max_factor);
}

}  // namespace floorloc
