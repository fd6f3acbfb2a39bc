// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace floorloc {

/// Errors of wheel odometry: prior standard deviations of the systematic ones, which the filter estimates, and the
/// initial noise, which it adapts.
struct OdometryNoise {
  double scale = 0.02;              ///< of distances, standard deviation
  double yaw_scale = 0.02;          ///< of turns
  double drift_rad_per_m = 0.005;   ///< false rotation per metre of path, standard deviation
  double noise_m = 0.004;           ///< after one metre; grows with the square root of the path
  double noise_rad = 0.007;         ///< after one metre, likewise
  double noise_rad_per_rad = 0.01;  ///< after a turn of one radian; grows with the square root of the turn
  double still_m = 2e-4;            ///< after one second, moving or not
  double still_rad = 2e-4;
};

/// Errors of visual odometry that its covariances do not include.
struct VisionNoise {
  double scale = 0.003;   ///< of distances: the camera's height over the floor, standard deviation
  double frame_m = 2e-3;  ///< per image, initial value: vibration of the camera
  double frame_rad = 1.5e-3;
};

/// Errors of an IMU; noise densities as in data sheets.
struct ImuNoise {
  double gyro = 1e-3;           ///< rad/s per root Hz; vibration included
  double gyro_bias = 0.02;      ///< rad/s, standard deviation at the start
  double gyro_walk = 1e-4;      ///< rad/s per root s
  double gyro_scale = 0.003;    ///< of turns
  double accelerometer = 0.03;  ///< m/s^2 per root Hz; vibration included
  double accelerometer_bias = 0.2;
  double accelerometer_walk = 2e-3;  ///< m/s^2 per root s; slopes of the floor included
};

/// How the noises of wheels and images are adapted to the residuals (covariance matching).
struct NoiseAdaptation {
  double rate = 0.1;         ///< per measurement; 0: never
  double min_factor = 0.05;  ///< limits of the factor on the variance
  double max_factor = 100.0;
};

/// Common error of nearby fixes (of the map and the calibration), which does not average out at standstill: a
/// first-order Gauss-Markov process along the path.
struct SharedFixNoise {
  double sigma_m = 2e-4;
  double sigma_rad = 3e-4;
  double correlation_m = 0.2;  ///< correlation length
};

/// Assumed motion of a vehicle while no sensor measures it (constant velocity, then a random walk).
struct MotionPrior {
  double acceleration_m_s2 = 1.0;  ///< standard deviation of the acceleration
  double speed_m_s = 0.5;
  double yaw_rate_rad_s = 0.5;
  double coast_s = 0.5;   ///< its velocity is assumed constant for this long
  double forget_s = 1.5;  ///< time constant with which a velocity that is not measured is forgotten
};

/// Which fixes are accepted.
struct FixGates {
  double max_distance_m = 0.20;                ///< jump from the predicted pose (thesis, 3.3.8)
  double max_angle_rad = 0.17453292519943295;  ///< 10 degrees
  /// Both are widened to this many standard deviations of the predicted pose.
  double sigmas = 4.0;
  double max_mahalanobis_squared = 25.0;  ///< chi-square, 3 degrees of freedom: 1.5e-5 of the right fixes are beyond
  double max_p_wrong = 1e-4;
};

/// When a vehicle counts as kidnapped: this many successive fixes contradict its pose and agree with each other after
/// propagation by odometry.
struct KidnapOptions {
  int fixes = 3;
  int near_fixes = 2;            ///< enough when the last one passes the distance and angle gates (wheel slip)
  double max_distance_m = 0.05;  ///< largest disagreement of two of these fixes ...
  double max_angle_rad = 0.06;
  double sigmas = 3.0;      ///< ... plus this many standard deviations of the motion between them
  double max_age_s = 10.0;  ///< older contradictions are forgotten

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// How wheel odometry is judged by the fixes. Defaults are for vehicles in halls; what each does to a faulty and to a
/// right odometry is measured by `./run bench fusion --faults`.
struct OdometryMonitorOptions {
  bool enabled = true;  ///< false: wheels are believed whatever the fixes say
  /// What a vehicle can do; a fix beyond it is wrong, or the vehicle was carried away. As PlanarOdometryOptions.
  double max_speed_m_s = 3.0;
  double max_yaw_rate_rad_s = 6.0;
  /// What it does while there is no odometry yet; industrial trucks brake with 1 to 2 m/s^2 (ISO 3691-4).
  double max_acceleration_m_s2 = 2.0;
  double max_acceleration_rad_s2 = 4.0;
  double min_motion_m = 0.15;  ///< by fixes or wheels, before a fix is compared with the one before
  double min_motion_rad = 0.1;
  /// Wheels that are off by less are right, and the filter learns what they are off by.
  double tolerance_m = 0.01;
  double tolerance_rad = 0.01;
  double tolerance_scale = 0.10;      ///< of distances
  double tolerance_yaw_scale = 0.05;  ///< of turns
  double tolerance_rad_per_m = 0.05;
  double contradiction = 2.5;  ///< times the tolerance: between once and this, an interval says nothing
  int fixes = 4;               ///< of which no two agree through the wheels: rejected
  int named_intervals = 2;     ///< that a known fault explains, and right wheels don't: rejected
  int intervals_to_trust = 3;  ///< that the fault does not explain, and right wheels do: trusted again
  double window_s = 30.0;      ///< what is older is forgotten
  double max_offset_s = 0.5;   ///< between the clocks of wheels and images; more is not compensated
  /// Residuals of right wheels with right stamps.
  double clock_sigma_m = 0.002;
  double clock_sigma_rad = 0.003;
  double clock_sigma_share = 0.015;
  double clock_interval_s = 0.6;  ///< between the fixes whose motion is compared
  int clock_min_intervals = 6;    ///< between fixes, before the clocks are compared
  double clock_min_gain = 25.0;   ///< of the squared residuals, before the offset is changed; as the Mahalanobis gate
  double clock_max_misfit = 4.0;  ///< of an interval's squared residuals at the offset found; 3 is exact
  double clock_max_left = 0.4;    ///< share of the squared residuals that the offset leaves

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// How a gyro is judged by the turns of the fixes: what no bias of a working one (0.09 rad/s at most, InvenSense
/// MPU-9250, 3.1) and no error of a stamp explains contradicts it. `./run bench fusion --faults`.
struct GyroMonitorOptions {
  double min_interval_s = 0.4;   ///< between the fixes that are compared
  double max_interval_s = 1.25;  ///< three fixes span twice that; half a turn cannot be told from its opposite
  double tolerance_rad = 0.05;
  double tolerance_scale = 0.3;  ///< of the turn
  double max_bias_rad_s = 0.1;
  double min_turn_rad = 0.3;  ///< less says nothing for a gyro
  int contradictions = 2;     ///< of three fixes each: not trusted
  int agreements = 4;         ///< in turns: trusted again

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Classes of accuracy of a pose; standard deviations.
struct FilterLimits {
  double localized_m = 0.01;
  double localized_rad = 0.0175;
  double lost_m = 0.5;
  double lost_rad = 0.35;
};

struct PoseFilterOptions {
  OdometryNoise odometry;
  NoiseAdaptation adaptation;
  VisionNoise vision;
  ImuNoise imu;
  SharedFixNoise shared_fix;
  MotionPrior motion_prior;
  FixGates gates;
  KidnapOptions kidnap;
  OdometryMonitorOptions monitor;
  GyroMonitorOptions gyro_monitor;
  FilterLimits limits;
  /// Where images or IMU contradict the wheels by more than this (Mahalanobis, squared), the wheels slip.
  double max_slip_mahalanobis_squared = 25.0;
  double history_s = 5.0;           ///< messages older than this are ignored
  std::size_t max_messages = 4096;  ///< remembered of each kind
  int clock_jump_messages = 5;      ///< this many successive messages before the history: a clock jump
  double clock_jump_sigma_m = 0.3;  ///< the motion while the clock was set is unknown: a second at walking pace
  double clock_jump_sigma_rad = 0.3;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

}  // namespace floorloc
