// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/filter_options.h"

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

using Named = std::pair<const char*, double>;

void RequirePositive(std::initializer_list<Named> values) {
  for (const auto& [name, value] : values) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(name) + " must be a positive number");
    }
  }
}

void RequireNotNegative(std::initializer_list<Named> values) {
  for (const auto& [name, value] : values) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(name) + " must not be negative");
    }
  }
}

}  // namespace

void KidnapOptions::Check() const {
  RequireOption(fixes >= 1, "kidnap.fixes must be at least 1");
  RequireOption(near_fixes >= 1, "kidnap.near_fixes must be at least 1");
  RequireNotNegative({{"kidnap.sigmas", sigmas}});
  RequirePositive({{"kidnap.max_distance_m", max_distance_m},
                   {"kidnap.max_angle_rad", max_angle_rad},
                   {"kidnap.max_age_s", max_age_s}});
}

void OdometryMonitorOptions::Check() const {
  RequirePositive({{"monitor.max_speed_m_s", max_speed_m_s},
                   {"monitor.max_yaw_rate_rad_s", max_yaw_rate_rad_s},
                   {"monitor.max_acceleration_m_s2", max_acceleration_m_s2},
                   {"monitor.max_acceleration_rad_s2", max_acceleration_rad_s2},
                   {"monitor.min_motion_m", min_motion_m},
                   {"monitor.min_motion_rad", min_motion_rad},
                   {"monitor.tolerance_m", tolerance_m},
                   {"monitor.tolerance_rad", tolerance_rad},
                   {"monitor.tolerance_scale", tolerance_scale},
                   {"monitor.tolerance_yaw_scale", tolerance_yaw_scale},
                   {"monitor.tolerance_rad_per_m", tolerance_rad_per_m},
                   {"monitor.window_s", window_s},
                   {"monitor.max_offset_s", max_offset_s},
                   {"monitor.clock_sigma_m", clock_sigma_m},
                   {"monitor.clock_sigma_rad", clock_sigma_rad},
                   {"monitor.clock_sigma_share", clock_sigma_share},
                   {"monitor.clock_interval_s", clock_interval_s},
                   {"monitor.clock_min_gain", clock_min_gain},
                   {"monitor.clock_max_misfit", clock_max_misfit},
                   {"monitor.clock_max_left", clock_max_left}});
  RequireOption(contradiction > 1.0, "monitor.contradiction must be more than 1");
  RequireOption(fixes >= 3, "monitor.fixes must be at least 3");
  RequireOption(named_intervals >= 2, "monitor.named_intervals must be at least 2");
  RequireOption(intervals_to_trust >= 1, "monitor.intervals_to_trust must be at least 1");
  RequireOption(clock_min_intervals >= 3, "monitor.clock_min_intervals must be at least 3");
}

void GyroMonitorOptions::Check() const {
  RequirePositive({{"gyro_monitor.min_interval_s", min_interval_s},
                   {"gyro_monitor.max_interval_s", max_interval_s},
                   {"gyro_monitor.min_turn_rad", min_turn_rad},
                   {"gyro_monitor.tolerance_rad", tolerance_rad},
                   {"gyro_monitor.tolerance_scale", tolerance_scale},
                   {"gyro_monitor.max_bias_rad_s", max_bias_rad_s}});
  RequireOption(contradictions >= 1, "gyro_monitor.contradictions must be at least 1");
  RequireOption(agreements >= 1, "gyro_monitor.agreements must be at least 1");
}

void PoseFilterOptions::Check() const {
  RequireNotNegative({{"odometry.scale", odometry.scale},
                      {"odometry.yaw_scale", odometry.yaw_scale},
                      {"odometry.drift_rad_per_m", odometry.drift_rad_per_m},
                      {"odometry.noise_m", odometry.noise_m},
                      {"odometry.noise_rad", odometry.noise_rad},
                      {"odometry.noise_rad_per_rad", odometry.noise_rad_per_rad},
                      {"adaptation.rate", adaptation.rate},
                      {"vision.scale", vision.scale},
                      {"imu.gyro_bias", imu.gyro_bias},
                      {"imu.gyro_walk", imu.gyro_walk},
                      {"imu.gyro_scale", imu.gyro_scale},
                      {"imu.accelerometer_bias", imu.accelerometer_bias},
                      {"imu.accelerometer_walk", imu.accelerometer_walk}});
  RequirePositive({{"odometry.still_m", odometry.still_m},
                   {"odometry.still_rad", odometry.still_rad},
                   {"shared_fix.sigma_m", shared_fix.sigma_m},
                   {"shared_fix.sigma_rad", shared_fix.sigma_rad},
                   {"shared_fix.correlation_m", shared_fix.correlation_m},
                   {"adaptation.min_factor", adaptation.min_factor},
                   {"adaptation.max_factor", adaptation.max_factor},
                   {"max_slip_mahalanobis_squared", max_slip_mahalanobis_squared},
                   {"vision.frame_m", vision.frame_m},
                   {"vision.frame_rad", vision.frame_rad},
                   {"imu.gyro", imu.gyro},
                   {"imu.accelerometer", imu.accelerometer},
                   {"motion_prior.acceleration_m_s2", motion_prior.acceleration_m_s2},
                   {"motion_prior.speed_m_s", motion_prior.speed_m_s},
                   {"motion_prior.yaw_rate_rad_s", motion_prior.yaw_rate_rad_s},
                   {"motion_prior.coast_s", motion_prior.coast_s},
                   {"motion_prior.forget_s", motion_prior.forget_s},
                   {"gates.max_distance_m", gates.max_distance_m},
                   {"gates.max_angle_rad", gates.max_angle_rad},
                   {"gates.sigmas", gates.sigmas},
                   {"gates.max_mahalanobis_squared", gates.max_mahalanobis_squared},
                   {"gates.max_p_wrong", gates.max_p_wrong},
                   {"limits.localized_m", limits.localized_m},
                   {"limits.localized_rad", limits.localized_rad},
                   {"limits.lost_m", limits.lost_m},
                   {"limits.lost_rad", limits.lost_rad},
                   {"clock_jump_sigma_m", clock_jump_sigma_m},
                   {"clock_jump_sigma_rad", clock_jump_sigma_rad},
                   {"history_s", history_s}});
  kidnap.Check();
  monitor.Check();
  gyro_monitor.Check();
  RequireOption(clock_jump_messages >= 1, "clock_jump_messages must be at least 1");
  RequireOption(max_messages >= 16, "max_messages must be at least 16");
}

}  // namespace floorloc
